//! Checks and refines the calibration of a scene by some of its frames.

use crate::{
    arguments::{Evidence, List},
    json::to_value,
    progress::Console,
    run::Run,
    steps::Steps,
    video::Videos,
    warning::WarningReport,
};
use pcmvs_core::{
    Camera, Progress, Rig, View,
    calibration::{self, Calibration, CalibrationParams, CameraReport, Finding, Verdict, calibrate},
};
use pcmvs_scene::{
    Disk, Failure, FrameFiles, Pictures, Scene, SceneCamera, SceneFrame, Silhouettes, Threads, thread_count,
};
use serde_json::{Value, json};
use std::{mem::take, sync::atomic::AtomicBool};

/// Frames that are used if none are asked for.
const FRAMES: usize = 4;

/// Calibrates the cameras of a scene as asked, and writes what was found to the terminal. `with_steps` also finds cameras that
/// are out of step.
pub fn calibrated(
    scene: &mut Scene,
    asked: &Evidence,
    params: &CalibrationParams,
    with_steps: bool,
    cancelled: &AtomicBool,
) -> Result<Found, Failure> {
    let cameras = scene.cameras()?;
    let silhouettes = Silhouettes::new(asked.common.masks.files(), scene)?;
    let threads = Threads::new(thread_count(asked.common.threads))?;
    let console = Console::new(cancelled);
    let videos = Videos::open(scene)?;
    let run = Run { scene, silhouettes, videos: &videos, threads: &threads, console: &console };
    let mut found = run.calibrate(&cameras, &evidence(scene, asked.frames.as_ref())?, params)?;
    if with_steps {
        found.steps = run.steps(&cameras, asked.frames.as_ref())?;
    }
    found.print(scene, &console);
    Ok(found)
}

/// What was found, and in which frames.
pub struct Found {
    pub calibration: Calibration,
    pub frames: Vec<u32>,
    /// Cameras whose pictures are exchanged in the scene, and whose calibrations are therefore exchanged here.
    pub exchanged: Option<[usize; 2]>,
    /// Which cameras are out of step, if that was asked for and there are several frames.
    pub steps: Option<Steps>,
}

/// The frames to use, sorted by index: those asked for, or a few that are spread over the scene.
pub fn evidence(scene: &Scene, asked: Option<&List>) -> Result<Vec<SceneFrame>, Failure> {
    let (mut frames, most) = match asked {
        Some(List(asked)) => {
            (asked.iter().map(|&index| scene.frame(index)).collect::<Result<Vec<_>, _>>()?, asked.len())
        }
        None => (scene.frames.iter().collect(), FRAMES),
    };
    frames.sort_by_key(|frame| frame.index);
    let count = frames.len().min(most);
    Ok((0..count).map(|i| frames[i * frames.len() / count].clone()).collect())
}

impl Run<'_> {
    /// Calibrates the cameras by some frames. If two cameras' pictures are exchanged, their calibrations are, and the
    /// result is that of the exchanged ones.
    pub fn calibrate(
        &self,
        cameras: &[Camera],
        frames: &[SceneFrame],
        params: &CalibrationParams,
    ) -> Result<Found, Failure> {
        let pictures = frames.iter().map(|frame| self.pictures(frame)).collect::<Result<Vec<_>, _>>()?;
        let calibration = self.once(cameras, frames, &pictures, params)?;
        let mut found =
            Found { calibration, frames: frames.iter().map(|f| f.index).collect(), exchanged: None, steps: None };
        let swapped = found.calibration.findings.iter().find_map(|finding| match finding {
            Finding::CamerasSwapped { first, second } => Some([*first as usize, *second as usize]),
            _ => None,
        });
        if let Some([a, b]) = swapped
            && (cameras[a].width, cameras[a].height) == (cameras[b].width, cameras[b].height)
        {
            let mut exchanged = cameras.to_vec();
            exchanged.swap(a, b);
            let mut again = self.once(&exchanged, frames, &pictures, params)?;
            again.findings.insert(0, Finding::CamerasSwapped { first: a as u32, second: b as u32 });
            again.verdict = Verdict::Improved;
            found.calibration = again;
            found.exchanged = Some([a, b]);
        }
        Ok(found)
    }

    /// The decoded pictures of a frame.
    fn pictures(&self, frame: &SceneFrame) -> Result<Pictures, Failure> {
        let mut files = FrameFiles::read(&Disk, self.videos, self.scene, frame, self.silhouettes)?;
        let missing = take(&mut files.missing);
        let missing = missing.into_iter().map(|file| WarningReport::of_missing(file, self.scene, frame));
        missing.for_each(|warning| self.console.warn(&warning));
        files.decode(self.threads)
    }

    fn once(
        &self,
        cameras: &[Camera],
        frames: &[SceneFrame],
        pictures: &[Pictures],
        params: &CalibrationParams,
    ) -> Result<Calibration, Failure> {
        let rig = Rig::new(cameras).map_err(|error| self.scene.explain(&error, None))?;
        let of_frames = frames.iter().zip(pictures).map(|(frame, pictures)| self.views(&rig, frame, pictures));
        let views: Vec<Vec<View>> = of_frames.collect::<Result<_, _>>()?;
        let views: Vec<&[View]> = views.iter().map(Vec::as_slice).collect();
        let progress = self.console.frame(frames.first().map_or(0, |frame| frame.index));
        let frame = if let [frame] = frames { Some(frame) } else { None };
        progress.begin("calibrate");
        let result = calibrate(&rig, &views, params, self.threads, &progress as &dyn Progress);
        progress.end("calibrate");
        result.map_err(|error| self.scene.explain(&error, frame))
    }

    /// The views of a frame, in the rig's order, without their colours.
    fn views(&self, rig: &Rig, frame: &SceneFrame, pictures: &Pictures) -> Result<Vec<View>, Failure> {
        let (order, inputs) = (rig.order(), pictures.inputs());
        let made = self.threads.map(order.len(), |place| {
            if self.console.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            let camera = order[place] as usize;
            let view = calibration::view(rig, camera, inputs[camera].as_ref());
            view.map_err(|error| self.scene.explain(&error, Some(frame)))
        });
        made.into_iter().collect()
    }
}

/// A number with a fixed number of digits, or a dash.
fn number(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| String::from("-"), |v| format!("{v:.digits$}"))
}

/// A number as JSON, rounded to what it is worth.
fn rounded(value: Option<f64>) -> Value {
    value.map_or(Value::Null, |v| to_value(&((v * 1e4).round() / 1e4)))
}

impl Found {
    /// The cameras to go on with.
    pub fn cameras(&self) -> &[Camera] {
        &self.calibration.cameras
    }

    /// Whether something is wrong with the given calibration, or cameras are out of step.
    pub fn is_doubtful(&self) -> bool {
        !self.calibration.findings.is_empty() || self.steps.as_ref().is_some_and(Steps::is_any_out)
    }

    /// What became of the refinement, in one sentence.
    pub fn summary(&self) -> String {
        let Calibration { verdict, epipolar_bias_px, points, .. } = &self.calibration;
        let bias = epipolar_bias_px.map_or_else(String::new, |[before, after]| {
            format!(": epipolar lines miss by {before:.2} px, and by {after:.2} px with a refined calibration")
        });
        let verdict = match verdict {
            Verdict::Improved => "the calibration can be improved",
            Verdict::Kept => "a refined calibration would not be better",
            Verdict::Undecided => "there are too few matches to judge the calibration",
        };
        format!("{verdict} ({points} points){bias}")
    }

    /// The findings, with the names of the cameras.
    pub fn warnings(&self, scene: &Scene) -> Vec<WarningReport> {
        let name = |camera: u32| scene.cameras[camera as usize].name.clone();
        let message = |finding: &Finding| match finding.cameras() {
            [Some(first), Some(second)] => format!("cameras `{}` and `{}`: {finding}", name(first), name(second)),
            [Some(camera), None] => format!("camera `{}`: {finding}", name(camera)),
            _ => finding.to_string(),
        };
        let report = |finding: &Finding| WarningReport {
            code: finding.code().to_owned(),
            frame: None,
            camera: finding.cameras()[0].map(name),
            message: format!("{}: {}", scene.path.display(), message(finding)),
        };
        // What is out of step also looks as if it had been moved, so that it comes first.
        let steps = self.steps.iter().flat_map(|steps| steps.warnings(scene));
        steps.chain(self.calibration.findings.iter().map(report)).collect()
    }

    /// Writes one line per camera and the warnings.
    pub fn print(&self, scene: &Scene, console: &Console) {
        console.line("camera           overlap  contour px      epipolar px     moved px      gain   late");
        for (i, (camera, report)) in scene.cameras.iter().zip(&self.calibration.reports).enumerate() {
            let CameraReport { given, refined, moved_px, uncertainty, silhouette_overlap, gain } = report;
            let change = |before: Option<f64>, after: Option<f64>| {
                format!("{:>5} -> {:<5}", number(before, 2), number(after, 2))
            };
            let sigma = uncertainty.map(|of| of.object_px);
            console.line(&format!(
                "{:16} {:>7}  {}  {}  {:>5} ±{:<5}  {}  {:>5}",
                camera.name,
                number(*silhouette_overlap, 3),
                change(given.contour_px, refined.contour_px),
                change(given.epipolar_px, refined.epipolar_px),
                number(Some(*moved_px), 2),
                number(sigma, 2),
                number(*gain, 3),
                self.late(i).map_or_else(|| String::from("-"), |late| late.to_string()),
            ));
        }
        console.line(&self.summary());
        if let Some(unknown) = self.steps.as_ref().and_then(Steps::unknown) {
            console.line(&unknown);
        }
        self.warnings(scene).iter().for_each(|warning| console.warn(warning));
    }

    /// The frames by which a camera is late, if that is known.
    fn late(&self, camera: usize) -> Option<i32> {
        self.steps.as_ref()?.late[camera]
    }

    /// All figures.
    pub fn to_json(&self, scene: &Scene) -> Value {
        let camera = |(i, (camera, report)): (usize, (&SceneCamera, &CameraReport))| {
            let CameraReport { given, refined, moved_px, uncertainty, silhouette_overlap, gain } = report;
            json!({
                "name": camera.name,
                "silhouette_overlap": rounded(*silhouette_overlap),
                "contour_px": rounded(given.contour_px),
                "epipolar_px": rounded(given.epipolar_px),
                "matches": given.matches,
                "match_noise_px": rounded(given.noise_px),
                "gain": rounded(*gain),
                "time_offset": self.late(i),
                "refined": {
                    "contour_px": rounded(refined.contour_px),
                    "epipolar_px": rounded(refined.epipolar_px),
                    "moved_px": rounded(Some(*moved_px)),
                    "sigma_px": rounded(uncertainty.map(|of| of.object_px)),
                    "direction_sigma_px": rounded(uncertainty.map(|of| of.direction_px)),
                    "roll_sigma_px": rounded(uncertainty.map(|of| of.roll_px)),
                    "centre_sigma_px": rounded(uncertainty.map(|of| of.centre_px)),
                },
            })
        };
        let Calibration { verdict, reports, held_out, epipolar_bias_px, points, .. } = &self.calibration;
        let pair = |values: &Option<[f64; 2]>| {
            values.map_or(Value::Null, |[given, refined]| json!([rounded(Some(given)), rounded(Some(refined))]))
        };
        json!({
            "frames": self.frames,
            "verdict": match verdict {
                Verdict::Improved => "improved",
                Verdict::Kept => "kept",
                Verdict::Undecided => "undecided",
            },
            "points": points,
            "epipolar_bias_px": pair(epipolar_bias_px),
            "held_out_loss": pair(held_out),
            "exchanged": self.exchanged,
            "cameras": scene.cameras.iter().zip(reports).enumerate().map(camera).collect::<Vec<_>>(),
            "warnings": self.warnings(scene),
        })
    }
}
