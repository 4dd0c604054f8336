//! From views to a checked and refined calibration.

use super::{
    adjust::{Priors, adjust, covariance},
    brightness::gains,
    finding::Finding,
    instant::{GuideParams, Instant},
    matching::{self, Brightness},
    model::{Model, PARAMETERS, SHIFT},
    overlap::{Fit, fit},
    prior::{SHARED, Spread, spreads},
    report::{Calibration, CameraReport, Uncertainty, Verdict},
    residuals::{Residuals, all_tangencies, epipolar_bias, held_out_loss, residuals},
    statistics::{median, robust_sigma},
    tangents::{self, misses},
    track::{Source, Track},
};
use crate::{
    error::{Error, Result},
    executor::Executor,
    hull::{AgreementParams, HullParams},
    math::{max, ordered},
    params::{Params, Preset},
    progress::{self, Onward, Part, Progress},
    rig::Rig,
    silhouette::{ContourEdge, ContourFault},
    stage::Stage,
    view::{View, ViewInput},
};
use alloc::{vec, vec::Vec};
use glam::DVec3;

/// Parameters of the calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CalibrationParams {
    /// Voxels of the hull that guides matching, in pixels of footprint.
    pub voxel_pixels: f32,
    /// Agreement of the silhouettes that carve it. Without it all of them do.
    pub agreement: Option<AgreementParams>,
    /// Rounds of matching and adjustment, 1 to 100. Each starts from the cameras of the one before.
    pub rounds: u32,
    /// How far matches may be from where they are expected in the first round, in pixels, at most 64.
    pub reach_pixels: u32,
    /// Also refines focal length and principal point of each camera. Rings of few cameras determine them weakly.
    pub intrinsics: bool,
}

impl Default for CalibrationParams {
    fn default() -> Self {
        let agreement = Params::preset(Preset::Default).agreement;
        Self { voxel_pixels: 3.0, agreement, rounds: 3, reach_pixels: 8, intrinsics: false }
    }
}

/// Bounds of [`CalibrationParams::rounds`] and [`CalibrationParams::reach_pixels`].
const MOST_ROUNDS: u32 = 100;
const MOST_REACH: u32 = 64;
/// Reach in the rounds after the first one, in pixels.
const LATER_REACH: usize = 3;
/// Scales of the loss in pixels for aligning contours: from gross errors to small ones.
const CONTOUR_SCALES: [f64; 6] = [32.0, 16.0, 8.0, 4.0, 2.0, 1.0];
/// Contours are aligned before matching only if that makes their misses smaller by this factor.
const ALIGNED: f64 = 0.7;
/// Least standard deviation of a point of tangency in pixels.
const CONTOUR_SIGMA: f64 = 0.3;
/// Scales of the loss in standard deviations for the first round, and for later ones.
const FIRST_SCALES: [f64; 4] = [32.0, 12.0, 5.0, 3.0];
const LATER_SCALES: [f64; 2] = [5.0, 3.0];
/// Refined cameras must make the loss of what was held out smaller by this factor.
const BETTER: f64 = 0.97;
/// The median miss of the contours may grow by this factor, and by this many pixels. If it grows more, the matches that have
/// become better were wrong together.
const CONTOURS_MAY_GROW: [f64; 2] = [1.25, 0.05];
/// A camera was bumped if its correction is this many pixels, and this many times the median correction.
const BUMPED: [f64; 2] = [1.5, 4.0];
/// A camera contradicts the others if after all its contour misses by this many pixels, and this many times the median.
const CONTRADICTS: [f64; 2] = [3.0, 4.0];
/// A camera is supported by texture if it has at least this many matches,
const SUPPORTING: u32 = 100;
/// and their median distance from epipolar lines is at most this, in pixels, or this many times that of all cameras.
const SUPPORTED: [f64; 2] = [0.5, 3.0];
/// A camera with fewer observations keeps its given pose.
const DETERMINED: u32 = 30;
/// Points at which corrections are measured, per camera.
const MEASURED: usize = 400;

/// A camera's view for [`calibrate`]: with its contour from the photograph, and without its colours, which nothing reads. A
/// camera without picture in the frame has no `input`.
///
/// # Errors
/// Those of [`View::new`].
pub fn view(rig: &Rig, camera: usize, input: Option<&ViewInput>) -> Result<View> {
    let contour = Params::preset(Preset::Default).contour;
    let view = match input {
        Some(input) => View::new(rig, camera, input, contour.as_ref())?,
        None => View::absent(rig, camera)?,
    };
    Ok(View { rgb: Vec::new(), ..view })
}

/// Checks and refines the cameras of a rig by the views of one or more frames of a take. Each frame has one view per
/// camera, in the order of [`Rig::order`], as [`crate::Frame::views`] gives them. Their pictures and silhouettes were made
/// with the given calibration.
///
/// # Errors
/// [`Error::ViewCount`], those of the hull, and [`Error::Cancelled`].
pub fn calibrate(
    rig: &Rig,
    frames: &[&[View]],
    params: &CalibrationParams,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Calibration> {
    let count = rig.cameras().len();
    if let Some(views) = frames.iter().find(|views| views.len() != count) {
        return Err(Error::ViewCount { given: views.len() as u32, cameras: count as u32 });
    }
    let ordered = rig.order().iter().map(|&i| &rig.cameras()[i as usize]);
    let given: Vec<Model> = ordered.map(|camera| Model::new(camera, rig.origin())).collect();
    let instants: Vec<Instant> = frames.iter().map(|views| Instant::new(views, executor)).collect();
    let rounds = params.rounds.clamp(1, MOST_ROUNDS);
    let steps = rounds + 2;
    let hull = GuideParams { hull: HullParams { voxel_pixels: params.voxel_pixels }, agreement: params.agreement };
    // Hulls may be carved again, and those of several frames are one step where overlaps are found.
    let onward = Onward::new(progress);
    let progress: &dyn Progress = &onward;
    let part = |part: u32| Part { of: progress, stage: Stage::Detect, part, parts: steps };
    progress::step(progress, Stage::Detect, 0, steps)?;

    let fit = fit(&instants, &given, &hull, executor, &part(0))?;
    let mut models = align_contours(&given, &instants);
    progress::step(progress, Stage::Detect, 1, steps)?;

    let mut priors = Spread::priors(&given, &vec![Spread::FIRST; count], params.intrinsics);
    let mut evidence = Evidence::default();
    for round in 0..rounds {
        let reach = if round == 0 { params.reach_pixels.min(MOST_REACH) as usize } else { LATER_REACH };
        evidence = Evidence::new(rig, &instants, &models, &hull, reach, executor, &part(round + 1))?;
        let scales: &[f64] = if round == 0 { &FIRST_SCALES } else { &LATER_SCALES };
        adjust(&mut models, &mut evidence.tracks, &priors, scales);
        priors = Spread::priors(&given, &spreads(&given, &models), params.intrinsics);
        progress::step(progress, Stage::Detect, round + 2, steps)?;
    }
    let contradicts = contradicts(&models, &instants, &evidence);
    restore(&given, &mut models, &contradicts, &evidence);
    let judge = Judge {
        rig,
        instants: &instants,
        given: &given,
        models: &models,
        evidence: &evidence,
        priors: &priors,
        contradicts: &contradicts,
    };
    let mut found = judge.result(&fit);
    found.findings.extend(contour_faults(rig, frames).into_iter().map(Finding::Contour));
    progress::step(progress, Stage::Detect, steps, steps)?;
    Ok(found)
}

/// What the pictures of all frames say about the contours: of each camera that of the frame that fits best, because masks may be
/// wrong in single frames.
fn contour_faults(rig: &Rig, frames: &[&[View]]) -> Vec<ContourFault> {
    let edge = |camera: usize| {
        let place = rig.place(camera)?;
        let worse = |edge: &ContourEdge| ordered(max(edge.strength, edge.usual));
        let best = frames.iter().filter_map(|views| views[place].edge).min_by_key(worse)?;
        Some((camera as u32, best))
    };
    ContourFault::of((0..rig.cameras().len()).filter_map(edge))
}

/// Whether refined cameras do not make the contours miss each other clearly more than before.
fn contours_agree(before: &[Residuals], after: &[Residuals]) -> bool {
    let miss = |found: &[Residuals]| median(&mut found.iter().filter_map(|r| r.contour_px).collect::<Vec<_>>());
    let [factor, pixels] = CONTOURS_MAY_GROW;
    miss(before).zip(miss(after)).is_none_or(|(before, after)| after <= factor * before + pixels)
}

/// Which cameras contradict the others wherever they are put: their contours do, or their silhouettes do and no texture
/// speaks for them. Such a camera did not move, but shows something else.
fn contradicts(models: &[Model], instants: &[Instant], evidence: &Evidence) -> Vec<bool> {
    let found = residuals(instants, models, &evidence.tracks);
    let by_contour = far_off(&found.iter().map(|r| r.contour_px).collect::<Vec<_>>());
    let mut sizes: Vec<f64> = found.iter().filter_map(|r| r.epipolar_px).collect();
    let limit = SUPPORTED[0].max(SUPPORTED[1] * median(&mut sizes).unwrap_or(0.0));
    let is_supported = |r: &Residuals| r.matches >= SUPPORTING && r.epipolar_px.is_some_and(|d| d < limit);
    let is_one = |i: usize| by_contour[i] || evidence.is_apart(i, instants) && !is_supported(&found[i]);
    (0..models.len()).map(is_one).collect()
}

/// Puts cameras back to the given pose that contradict the others or are not determined.
fn restore(given: &[Model], models: &mut [Model], contradicts: &[bool], evidence: &Evidence) {
    let mut seen = vec![0; models.len()];
    evidence.tracks.iter().flat_map(|t| &t.observations).for_each(|seen_by| seen[usize::from(seen_by.camera)] += 1);
    for i in 0..models.len() {
        if contradicts[i] || seen[i] < DETERMINED {
            models[i] = given[i];
        }
    }
}

/// Whose contours miss those of the others far more than usual. `misses` are in pixels, by place.
fn far_off(misses: &[Option<f64>]) -> Vec<bool> {
    let usual = median(&mut misses.iter().flatten().copied().collect::<Vec<f64>>()).unwrap_or(0.0);
    let limit = CONTRADICTS[0].max(CONTRADICTS[1] * usual);
    misses.iter().map(|miss| miss.is_some_and(|miss| miss > limit)).collect()
}

/// Turns the cameras so that their contours agree: this finds errors of any size, of all cameras or of one. Returns the
/// given cameras if their contours agree about as well.
fn align_contours(given: &[Model], instants: &[Instant]) -> Vec<Model> {
    let mut models = given.to_vec();
    let priors = Spread::priors(given, &vec![Spread { shift: 0.0, ..Spread::FIRST }; given.len()], false);
    let miss = |models: &[Model]| {
        let sizes: Vec<f64> = misses(models.len(), &all_tangencies(instants, models)).into_iter().flatten().collect();
        // The mean, because a single camera may be far off.
        sizes.iter().sum::<f64>() / sizes.len().max(1) as f64
    };
    for scale in CONTOUR_SCALES {
        let mut tracks = tangents::tracks(&models, &all_tangencies(instants, &models), 1.0);
        adjust(&mut models, &mut tracks, &priors, &[scale]);
    }
    if miss(&models) < ALIGNED * miss(given) { models } else { given.to_vec() }
}

/// What the cameras are adjusted to.
#[derive(Default)]
struct Evidence {
    tracks: Vec<Track>,
    brightness: Vec<Brightness>,
    /// Standard deviation of points of tangency in pixels.
    contour_sigma: f64,
    /// For each camera the number of frames in which its silhouette shows what the others do not have.
    apart: Vec<usize>,
}

impl Evidence {
    /// Whether a camera's silhouette shows what the others do not have in most frames.
    fn is_apart(&self, place: usize, instants: &[Instant]) -> bool {
        2 * self.apart[place] > instants.len()
    }

    fn new(
        rig: &Rig,
        instants: &[Instant],
        models: &[Model],
        hull: &GuideParams,
        reach: usize,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let mut evidence = Self { apart: vec![0; models.len()], ..Self::default() };
        let found = all_tangencies(instants, models);
        let sizes: Vec<f64> = found.iter().map(|t| t.miss).collect();
        evidence.contour_sigma = robust_sigma(&sizes).unwrap_or(1.0).max(CONTOUR_SIGMA);
        let far_off = far_off(&misses(models.len(), &found));
        // Each frame is carved and then searched.
        let parts = 2 * instants.len() as u32;
        let part = |part: u32| Part { of: progress, stage: Stage::Detect, part, parts };
        for (frame, instant) in (0..).zip(instants) {
            let (carving, searching) = (part(2 * frame), part(2 * frame + 1));
            let guide = instant.hull(models, |i| far_off[i], hull, executor, &carving)?;
            guide.apart.iter().for_each(|&place| evidence.apart[usize::from(place)] += 1);
            let (tracks, brightness) = matching::tracks(rig, instant, models, &guide, reach, executor, &searching)?;
            evidence.tracks.extend(tracks);
            evidence.brightness.extend(brightness);
            let found = tangents::tangencies(models, &instant.outlines);
            let used: Vec<_> = found.into_iter().filter(|tangency| !tangency.held_out).collect();
            evidence.tracks.extend(tangents::tracks(models, &used, evidence.contour_sigma));
        }
        Ok(evidence)
    }
}

/// Compares the refined cameras with the given ones.
struct Judge<'a> {
    rig: &'a Rig,
    instants: &'a [Instant],
    given: &'a [Model],
    models: &'a [Model],
    evidence: &'a Evidence,
    priors: &'a Priors,
    /// By place.
    contradicts: &'a [bool],
}

impl Judge<'_> {
    fn result(&self, fit: &Fit) -> Calibration {
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
        let findings = self.findings(verdict, &reports, fit.exchanged, bias);
        Calibration { cameras, verdict, reports, held_out, epipolar_bias_px: bias, points, findings }
    }

    fn findings(
        &self,
        verdict: Verdict,
        reports: &[CameraReport],
        exchanged: Option<[usize; 2]>,
        bias: Option<[f64; 2]>,
    ) -> Vec<Finding> {
        let mut findings = Vec::new();
        let order = self.rig.order();
        let exchanged = exchanged.map(|places| places.map(|place| order[place]));
        if let Some([a, b]) = exchanged {
            findings.push(Finding::CamerasSwapped { first: a.min(b), second: a.max(b) });
        }
        let is_exchanged = |camera: u32| exchanged.is_some_and(|cameras| cameras.contains(&camera));
        let contradicts = |camera: u32| self.rig.place(camera as usize).is_some_and(|place| self.contradicts[place]);
        let mut moved: Vec<f64> = reports.iter().map(|r| r.moved_px).collect();
        let limit = BUMPED[0].max(BUMPED[1] * median(&mut moved).unwrap_or(0.0));
        for (camera, report) in (0..).zip(reports).filter(|&(camera, _)| !is_exchanged(camera)) {
            if contradicts(camera) {
                findings.push(Finding::CameraContradicts { camera, contour_px: report.refined.contour_px });
            } else if verdict == Verdict::Improved && report.moved_px > limit {
                findings.push(Finding::CameraBumped { camera, pixels: report.moved_px });
            }
        }
        // A single camera that was bumped raises the mean, but says nothing about the others.
        let bumped = findings.iter().any(|finding| matches!(finding, Finding::CameraBumped { .. }));
        if let Some([pixels, _]) = bias.filter(|_| verdict == Verdict::Improved && !bumped)
            && pixels > Finding::INCONSISTENT
        {
            findings.push(Finding::CalibrationInconsistent { pixels });
        }
        findings
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
        let scale = LATER_SCALES[LATER_SCALES.len() - 1];
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
