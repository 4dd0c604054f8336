//! Compares the refined cameras with the given ones: which are better, and what is wrong with the given ones.

use super::{
    adjust::{Priors, covariance},
    brightness::gains,
    cause::{Cause, cause, common_focal_length},
    evidence::Evidence,
    finding::Finding,
    instant::Instant,
    model::{Model, PARAMETERS, SHIFT},
    overlap::Fit,
    prior::SHARED,
    report::{Calibration, CameraReport, Uncertainty, Verdict},
    residuals::{Residuals, epipolar_bias, held_out_loss, residuals},
    statistics::median,
    track::{Source, Track},
};
use crate::{rig::Rig, silhouette::ContourFault};
use alloc::{vec, vec::Vec};
use glam::DVec3;

/// Scales of the loss in standard deviations for the focal lengths, from the given cameras on.
const COMMON_SCALES: [f64; 3] = [12.0, 5.0, 3.0];
/// The same for the covariance.
const UNCERTAIN_SCALE: f64 = 3.0;
/// Refined cameras must make the loss of what was held out smaller by this factor.
const BETTER: f64 = 0.97;
/// The median miss of the contours may grow by this factor, and by this many pixels. If it grows more, the matches that have
/// become better were wrong together.
const CONTOURS_MAY_GROW: [f64; 2] = [1.25, 0.05];
/// A camera was bumped if its correction is this many pixels, and this many times the median correction.
const BUMPED: [f64; 2] = [1.5, 4.0];
/// A camera is also looked at if matches are this many pixels, and this many times the median of all cameras, from its epipolar
/// lines. A wrong lens moves its picture of the object less than a bump does.
const FAR_LINES: [f64; 2] = [0.3, 4.0];
/// A silhouette that lacks something is named if it overlaps with the hull by less than this, even if what is left of its contour
/// fits. Smaller gaps do not harm the calibration, and every frame names them.
const PARTIAL: f64 = 0.75;
/// Points at which corrections are measured, per camera.
const MEASURED: usize = 400;

/// Compares the refined cameras with the given ones.
pub(super) struct Judge<'a> {
    pub(super) rig: &'a Rig,
    pub(super) instants: &'a [Instant],
    pub(super) given: &'a [Model],
    pub(super) models: &'a [Model],
    pub(super) evidence: &'a Evidence,
    pub(super) priors: &'a Priors,
    /// By place.
    pub(super) contradicts: &'a [bool],
}

impl Judge<'_> {
    pub(super) fn result(&self, fit: &Fit, faults: &[ContourFault]) -> Calibration {
        let Self { rig, instants, given, models, evidence, .. } = self;
        let tracks = &evidence.tracks;
        let before = residuals(instants, given, tracks);
        let after = residuals(instants, models, tracks);
        let mut noise: Vec<f64> = after.iter().filter_map(|r| r.noise_px).collect();
        let sigmas = [median(&mut noise).unwrap_or(1.0).max(0.05), evidence.contour_sigma];
        let loss = |models: &[Model]| held_out_loss(instants, models, tracks, sigmas);
        let held_out = loss(given).zip(loss(models)).map(|(before, after)| [before, after]);
        let verdict = match held_out {
            None => Verdict::Undecided,
            Some([a, b]) if b < BETTER * a && contours_agree(&before, &after) => Verdict::Improved,
            Some(_) => Verdict::Kept,
        };
        let (moved, uncertain) = (self.moved(), self.uncertainties());
        let gains = gains(given.len(), &evidence.brightness);
        let mut reports = vec![CameraReport::default(); given.len()];
        let mut cameras = rig.cameras().to_vec();
        for (place, &index) in rig.order().iter().enumerate() {
            reports[index as usize] = CameraReport {
                given: before[place],
                refined: after[place],
                moved_px: moved[place],
                uncertainty: uncertain[place],
                silhouette_overlap: fit.overlaps[place],
                gain: gains[place],
            };
            if verdict == Verdict::Improved {
                cameras[index as usize] = models[place].camera(rig.origin());
            }
        }
        let bias = epipolar_bias(given, tracks, 1).zip(epipolar_bias(models, tracks, 1)).map(|(a, b)| [a, b]);
        let points = tracks.iter().filter(|track| track.source == Source::Texture).count() as u32;
        let common = if verdict == Verdict::Improved { self.common_focal_length(loss) } else { None };
        let mut findings = self.findings(verdict, &reports, fit.exchanged, bias, common, faults);
        findings.extend(faults.iter().map(|&fault| Finding::Contour(fault)));
        Calibration { cameras, verdict, reports, held_out, epipolar_bias_px: bias, points, findings }
    }

    fn findings(
        &self,
        verdict: Verdict,
        reports: &[CameraReport],
        exchanged: Option<[usize; 2]>,
        bias: Option<[f64; 2]>,
        common: Option<f64>,
        faults: &[ContourFault],
    ) -> Vec<Finding> {
        let mut findings = Vec::new();
        let order = self.rig.order();
        let exchanged = exchanged.map(|places| places.map(|place| order[place]));
        if let Some([a, b]) = exchanged {
            findings.push(Finding::CamerasSwapped { first: a.min(b), second: a.max(b) });
        }
        let is_exchanged = |camera: u32| exchanged.is_some_and(|cameras| cameras.contains(&camera));
        if let Some(factor) = common {
            findings.push(Finding::FocalLengthWrong { camera: None, factor });
        }
        // What the pictures say against a mask explains what its silhouette lacks and contradicts. If it is said of all masks,
        // nothing of it tells about single cameras.
        let is_mask = |camera: u32| faults.iter().any(|fault| fault.camera().is_none_or(|other| other == camera));
        let mut moved: Vec<f64> = reports.iter().map(|r| r.moved_px).collect();
        let limit = BUMPED[0].max(BUMPED[1] * median(&mut moved).unwrap_or(0.0));
        let mut distances: Vec<f64> = reports.iter().filter_map(|r| r.given.epipolar_px).collect();
        let far = FAR_LINES[0].max(FAR_LINES[1] * median(&mut distances).unwrap_or(0.0));
        for (camera, report) in (0..).zip(reports).filter(|&(camera, _)| !is_exchanged(camera)) {
            let Some(place) = self.rig.place(camera as usize) else { continue };
            let (contradicts, frames) = (self.contradicts[place], self.evidence.lacking[place]);
            let is_partial = report.silhouette_overlap.is_some_and(|overlap| overlap < PARTIAL);
            if is_mask(camera) {
                // The fault names it.
            } else if frames > 0 && (contradicts || is_partial) {
                findings.push(Finding::SilhouetteSetAside { camera, frames, of: self.instants.len() as u32 });
            } else if contradicts {
                findings.push(Finding::CameraContradicts { camera, contour_px: report.refined.contour_px });
            }
            let is_off = [report.moved_px > limit, report.given.epipolar_px.is_some_and(|d| d > far)];
            if !contradicts && verdict == Verdict::Improved && is_off.contains(&true) {
                findings.extend(self.displaced(place, camera, report.moved_px, is_off[0]));
            }
        }
        // A single camera that is off raises the mean, but says nothing about the others.
        let is_explained = |finding: &Finding| {
            matches!(
                finding,
                Finding::CameraBumped { .. } | Finding::FocalLengthWrong { .. } | Finding::DistortionWrong { .. }
            )
        };
        let explained = findings.iter().any(is_explained);
        if let Some([pixels, _]) = bias.filter(|_| verdict == Verdict::Improved && !explained)
            && pixels > Finding::INCONSISTENT
        {
            findings.push(Finding::CalibrationInconsistent { pixels });
        }
        findings
    }

    /// What is probably wrong with a camera whose picture of the object has moved by so many pixels. Where the matches do not tell,
    /// it is named only if it `has_moved` so far that it must be wrong.
    fn displaced(&self, place: usize, camera: u32, pixels: f64, has_moved: bool) -> Option<Finding> {
        Some(match cause(&self.given[place], place, self.models, &self.evidence.tracks) {
            Cause::Pose => Finding::CameraBumped { camera, pixels, or_lens: false },
            Cause::FocalLength(factor) => Finding::FocalLengthWrong { camera: Some(camera), factor },
            Cause::Distortion(pixels) => Finding::DistortionWrong { camera, pixels },
            Cause::Unknown => return has_moved.then_some(Finding::CameraBumped { camera, pixels, or_lens: true }),
        })
    }

    /// The factor by which all focal lengths are too long, if that explains what was held out better than other poses do.
    fn common_focal_length(&self, loss: impl Fn(&[Model]) -> Option<f64>) -> Option<f64> {
        let tracks = &self.evidence.tracks;
        let (zoomed, factor) = common_focal_length(self.given, tracks, self.priors, &COMMON_SCALES)?;
        let (posed, zoomed) = loss(self.models).zip(loss(&zoomed))?;
        (zoomed < BETTER * posed).then_some(factor)
    }

    /// Points that a camera sees, evenly from all.
    fn seen_by(&self, place: usize) -> Vec<DVec3> {
        let sees = |track: &&Track| track.observations.iter().any(|seen| usize::from(seen.camera) == place);
        let all: Vec<DVec3> = self.evidence.tracks.iter().filter(sees).map(|track| track.point).collect();
        let step = all.len().div_ceil(MEASURED).max(1);
        all.into_iter().step_by(step).collect()
    }

    /// How far each camera's picture of the object has moved, in pixels.
    fn moved(&self) -> Vec<f64> {
        let of = |place: usize| {
            let points = self.seen_by(place);
            let moves = points.iter().filter_map(|&point| {
                Some((self.models[place].project(point)? - self.given[place].project(point)?).length_squared())
            });
            let squares: Vec<f64> = moves.collect();
            libm::sqrt(squares.iter().sum::<f64>() / squares.len().max(1) as f64)
        };
        (0..self.models.len()).map(of).collect()
    }

    fn uncertainties(&self) -> Vec<Option<Uncertainty>> {
        let scale = UNCERTAIN_SCALE;
        let Some(blocks) = covariance(self.models, &self.evidence.tracks, self.priors, scale) else {
            return vec![None; self.models.len()];
        };
        let of = |(place, block): (usize, [[f64; PARAMETERS]; PARAMETERS])| {
            let model = &self.models[place];
            let points = self.seen_by(place);
            let (mut sum, mut count) = (0.0, 0_u32);
            for at in points.iter().filter_map(|&point| model.linearise(point)) {
                for k in 0..PARAMETERS {
                    for l in 0..PARAMETERS {
                        sum += 0.5 * block[k][l] * at.by_camera[k].dot(at.by_camera[l]);
                    }
                }
                count += 1;
            }
            let root = |a: f64, b: f64| libm::sqrt(0.5 * (a + b)) * SHARED;
            (count > 0).then(|| Uncertainty {
                direction_px: root(block[0][0], block[1][1]) * model.focal(),
                roll_px: libm::sqrt(block[2][2]) * SHARED * 0.25 * model.width(),
                centre_px: root(block[SHIFT][SHIFT], block[SHIFT + 1][SHIFT + 1]) * model.focal()
                    / model.centre().length(),
                object_px: libm::sqrt(sum / f64::from(count)) * SHARED,
            })
        };
        blocks.into_iter().enumerate().map(of).collect()
    }
}

/// Whether refined cameras do not make the contours miss each other clearly more than before.
fn contours_agree(before: &[Residuals], after: &[Residuals]) -> bool {
    let miss = |found: &[Residuals]| median(&mut found.iter().filter_map(|r| r.contour_px).collect::<Vec<_>>());
    let [factor, pixels] = CONTOURS_MAY_GROW;
    miss(before).zip(miss(after)).is_none_or(|(before, after)| after <= factor * before + pixels)
}
