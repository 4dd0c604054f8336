//! What a calibration found: in total, per camera, and what is wrong.

use crate::{
    boundary::out,
    calibration::{pcmvs_calibration, shared},
    camera::pcmvs_camera,
    failure::Failure,
    sized::{Growing, write, write_versioned},
    status::pcmvs_status::{self, InvalidArgument},
    take::Take,
    text::text,
    warning::pcmvs_warning,
};
use pcmvs_core::calibration::{Calibration, CameraReport, Finding, Verdict};

/// Stands for a figure that could not be measured.
const NOT_MEASURED: f32 = -1.0;

/// What became of a refinement. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_verdict {
    /// The refined cameras agree better with a part of the evidence that was held out.
    Improved = 0,
    /// The refined cameras agree no better with it, so that the given ones are kept.
    Kept = 1,
    /// There are too few matches and contours to judge by, so that the given cameras are kept.
    Undecided = 2,
}

/// What a calibration found about the cameras as a whole. Figures that could not be measured are -1. Later versions may add
/// members at the end.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_calibration_report {
    /// A `pcmvs_verdict`.
    pub verdict: u32,
    /// Number of frames that were used.
    pub frames: u32,
    /// Number of points that were matched in two or more views.
    pub points: u32,
    /// Distance of matches from their epipolar lines with the given cameras, in pixels: the mean over all pairs of
    /// neighbouring cameras of the median, so that the noise of single matches does not count.
    pub epipolar_bias_px: f32,
    /// The same with the refined cameras.
    pub refined_epipolar_bias_px: f32,
    /// Mean loss over the evidence that was held out, with the given cameras. Smaller is better; it has no unit.
    pub held_out_loss: f32,
    /// The same with the refined cameras.
    pub refined_held_out_loss: f32,
    /// Indices of two cameras whose pictures seem to be exchanged, in ascending order. -1 if there are none.
    pub exchanged: [i32; 2],
}

impl Growing for pcmvs_calibration_report {
    const FIRST_SIZE: usize = 36;
}

/// What a calibration found about one camera. Figures that could not be measured are -1. Figures of the refined camera are
/// there even if the given one is kept. Later versions may add members at the end.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_camera_report {
    /// Intersection over union of the camera's silhouette and the visual hull of all cameras as given, 0 to 1: the mean over
    /// the frames.
    pub silhouette_overlap: f32,
    /// Brightness of its pictures over the mean of all cameras.
    pub gain: f32,
    /// Median distance by which the tangents from other silhouettes miss this camera's silhouette, in pixels, with the given
    /// cameras.
    pub contour_px: f32,
    /// The same with the refined cameras.
    pub refined_contour_px: f32,
    /// Median distance of this camera's matches from their epipolar lines, in pixels, with the given cameras.
    pub epipolar_px: f32,
    /// The same with the refined cameras.
    pub refined_epipolar_px: f32,
    /// How precise single matches are whatever the calibration is: robust standard deviation in pixels.
    pub match_noise_px: f32,
    /// Number of matches of this camera with others.
    pub matches: u32,
    /// How far the refinement moves the object in this camera's picture, as the root of the mean square, in pixels.
    pub moved_px: f32,
    /// Standard deviation of where the refined camera sees the object, in pixels.
    pub sigma_px: f32,
    /// Standard deviation of the refined camera's direction, in pixels.
    pub direction_sigma_px: f32,
    /// Standard deviation of its roll, in pixels at a quarter of the picture's width from the middle.
    pub roll_sigma_px: f32,
    /// Standard deviation of its centre across the line of sight, in pixels of footprint. It is correlated with that of the
    /// direction, because a turn and a shift look nearly alike: `sigma_px` is what counts.
    pub centre_sigma_px: f32,
}

impl Growing for pcmvs_camera_report {
    const FIRST_SIZE: usize = 52;
}

fn measured(value: Option<f64>) -> f32 {
    value.map_or(NOT_MEASURED, |value| value as f32)
}

impl pcmvs_calibration_report {
    fn of(found: &Calibration, frames: u32) -> Self {
        let Calibration { verdict, held_out, epipolar_bias_px, points, findings, .. } = found;
        let verdict = match verdict {
            Verdict::Improved => pcmvs_verdict::Improved,
            Verdict::Kept => pcmvs_verdict::Kept,
            Verdict::Undecided => pcmvs_verdict::Undecided,
        };
        let exchanged = findings.iter().find_map(|finding| match finding {
            Finding::CamerasSwapped { first, second } => Some([*first as i32, *second as i32]),
            _ => None,
        });
        let part = |pair: &Option<[f64; 2]>, i: usize| measured(pair.map(|pair| pair[i]));
        Self {
            verdict: verdict as u32,
            frames,
            points: *points,
            epipolar_bias_px: part(epipolar_bias_px, 0),
            refined_epipolar_bias_px: part(epipolar_bias_px, 1),
            held_out_loss: part(held_out, 0),
            refined_held_out_loss: part(held_out, 1),
            exchanged: exchanged.unwrap_or([-1, -1]),
        }
    }
}

impl From<&CameraReport> for pcmvs_camera_report {
    fn from(found: &CameraReport) -> Self {
        let CameraReport { given, refined, moved_px, uncertainty, silhouette_overlap, gain } = found;
        Self {
            silhouette_overlap: measured(*silhouette_overlap),
            gain: measured(*gain),
            contour_px: measured(given.contour_px),
            refined_contour_px: measured(refined.contour_px),
            epipolar_px: measured(given.epipolar_px),
            refined_epipolar_px: measured(refined.epipolar_px),
            match_noise_px: measured(given.noise_px),
            matches: given.matches,
            moved_px: *moved_px as f32,
            sigma_px: measured(uncertainty.map(|of| of.object_px)),
            direction_sigma_px: measured(uncertainty.map(|of| of.direction_px)),
            roll_sigma_px: measured(uncertainty.map(|of| of.roll_px)),
            centre_sigma_px: measured(uncertainty.map(|of| of.centre_px)),
        }
    }
}

impl From<&Finding> for pcmvs_warning {
    fn from(finding: &Finding) -> Self {
        let cameras = finding.cameras();
        let message = match cameras {
            [Some(first), Some(second)] => text(format_args!("cameras {first} and {second}: {finding}")),
            [Some(camera), None] => text(format_args!("camera {camera}: {finding}")),
            _ => text(finding),
        };
        let camera = cameras[1].or(cameras[0]).map_or(-1, |camera| camera as i32);
        Self { camera, reserved: 0, code: text(finding.code()), message }
    }
}

/// Returns what a calibration found about the cameras as a whole, once `pcmvs_calibration_run` has succeeded. `size` is
/// `sizeof *report`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_get_report(
    calibration: *const pcmvs_calibration,
    report: *mut pcmvs_calibration_report,
    size: usize,
) -> pcmvs_status {
    let get = |take: &Take| {
        let found = pcmvs_calibration_report::of(take.found()?, take.frames());
        // SAFETY: the caller's promise.
        unsafe { write(report, size, &found, "report") }
    };
    shared(calibration, get)
}

/// Returns what a calibration found about one camera, once `pcmvs_calibration_run` has succeeded. `size` is
/// `sizeof *report`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_get_camera_report(
    calibration: *const pcmvs_calibration,
    camera: u32,
    report: *mut pcmvs_camera_report,
    size: usize,
) -> pcmvs_status {
    let get = |take: &Take| {
        let found = pcmvs_camera_report::from(take.found_of(camera)?.1);
        // SAFETY: the caller's promise.
        unsafe { write(report, size, &found, "report") }.map_err(|f| f.of_camera(camera))
    };
    shared(calibration, get)
}

/// Returns a camera to go on with, once `pcmvs_calibration_run` has succeeded: the refined one if the verdict is
/// `PCMVS_VERDICT_IMPROVED`, else the given one. `index` counts the cameras as they were given to `pcmvs_rig_set_cameras`,
/// which takes the result. `size` is `sizeof *camera`, and the camera need not be initialised.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_get_camera(
    calibration: *const pcmvs_calibration,
    index: u32,
    camera: *mut pcmvs_camera,
    size: usize,
) -> pcmvs_status {
    let get = |take: &Take| {
        let found = pcmvs_camera::from_core(&take.found_of(index)?.0.cameras[index as usize]);
        // SAFETY: the caller's promise.
        unsafe { write_versioned(camera, size, &found, "camera") }.map_err(|f| f.of_camera(index))
    };
    shared(calibration, get)
}

/// Returns the number of warnings: what is wrong with the given cameras, once `pcmvs_calibration_run` has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_warning_count(
    calibration: *const pcmvs_calibration,
    count: *mut u32,
) -> pcmvs_status {
    let get = |take: &Take| {
        let count = out(count, "count")?;
        // SAFETY: the caller's promise.
        unsafe { count.write(take.found()?.findings.len() as u32) };
        Ok(())
    };
    shared(calibration, get)
}

/// Returns a warning. `index` is less than `pcmvs_calibration_warning_count`. Its code is "camera-bumped",
/// "focal-length-wrong", "distortion-wrong", "cameras-swapped", "camera-contradicts", "silhouette-set-aside",
/// "calibration-inconsistent", "contours-beside-edges", "contours-across-edges", "contour-beside-edge",
/// "contour-across-edge", "contour-without-edge" or "picture-blurred"; later versions may add codes. `size` is `sizeof *warning`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_get_warning(
    calibration: *const pcmvs_calibration,
    index: u32,
    warning: *mut pcmvs_warning,
    size: usize,
) -> pcmvs_status {
    let get = |take: &Take| {
        let findings = &take.found()?.findings;
        let found = findings.get(index as usize).ok_or_else(|| {
            let problem = format!("there is no warning {index}: the calibration has {}", findings.len());
            Failure::new(InvalidArgument, problem)
        })?;
        // SAFETY: the caller's promise.
        unsafe { write(warning, size, &found.into(), "warning") }
    };
    shared(calibration, get)
}
