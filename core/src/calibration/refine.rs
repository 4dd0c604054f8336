//! From views to a checked and refined calibration.

use super::{
    adjust::adjust,
    evidence::{Evidence, far_off},
    instant::{GuideParams, Instant},
    judge::Judge,
    model::Model,
    overlap::fit,
    prior::{Spread, spreads},
    report::Calibration,
    residuals::{Residuals, all_tangencies, residuals},
    statistics::median,
    tangents::{self, misses},
};
use crate::{
    error::{Error, Result},
    executor::Executor,
    hull::{AgreementParams, HullParams},
    math::{max, min, ordered},
    params::{Params, Preset},
    progress::{self, Onward, Part, Progress},
    rig::Rig,
    silhouette::{ContourEdge, ContourFault},
    stage::Stage,
    view::{View, ViewInput},
};
use alloc::{vec, vec::Vec};

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
/// Scales of the loss in standard deviations for the first round, and for later ones.
const FIRST_SCALES: [f64; 4] = [32.0, 12.0, 5.0, 3.0];
const LATER_SCALES: [f64; 2] = [5.0, 3.0];
/// A camera is supported by texture if it has at least this many matches,
const SUPPORTING: u32 = 100;
/// and their median distance from epipolar lines is at most this, in pixels, or this many times that of all cameras.
const SUPPORTED: [f64; 2] = [0.5, 3.0];
/// A camera with fewer observations keeps its given pose.
const DETERMINED: u32 = 30;

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
    let found = judge.result(&fit, &contour_faults(rig, frames));
    progress::step(progress, Stage::Detect, steps, steps)?;
    Ok(found)
}

/// What the pictures of all frames say about the contours: of each camera that of the frame that fits best, because masks may be
/// wrong in single frames, and the width of the edge in the frame where it is sharpest, because who moves fast is blurred.
fn contour_faults(rig: &Rig, frames: &[&[View]]) -> Vec<ContourFault> {
    let edge = |camera: usize| {
        let place = rig.place(camera)?;
        let worse = |edge: &ContourEdge| ordered(max(max(edge.strength, edge.usual), min(edge.far[0], edge.far[1])));
        let edges = || frames.iter().filter_map(|views| views[place].edge);
        let best = edges().min_by_key(worse)?;
        let width = edges().map(|edge| edge.width).fold(best.width, min);
        Some((camera as u32, ContourEdge { width, ..best }))
    };
    ContourFault::of((0..rig.cameras().len()).filter_map(edge))
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
