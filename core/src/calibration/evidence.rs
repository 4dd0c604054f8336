//! What the cameras are adjusted to: matches of texture and points of tangency.

use super::{
    instant::{GuideParams, Instant},
    matching::{self, Brightness},
    model::Model,
    residuals::all_tangencies,
    statistics::{median, robust_sigma},
    tangents::{self, misses},
    track::Track,
};
use crate::{
    error::Result,
    executor::Executor,
    progress::{Part, Progress},
    rig::Rig,
    stage::Stage,
};
use alloc::{vec, vec::Vec};

/// Least standard deviation of a point of tangency in pixels.
const CONTOUR_SIGMA: f64 = 0.3;
/// A camera contradicts the others if after all its contour misses by this many pixels, and this many times the median.
const CONTRADICTS: [f64; 2] = [3.0, 4.0];

/// What the cameras are adjusted to.
#[derive(Default)]
pub(super) struct Evidence {
    pub(super) tracks: Vec<Track>,
    pub(super) brightness: Vec<Brightness>,
    /// Standard deviation of points of tangency in pixels.
    pub(super) contour_sigma: f64,
    /// For each camera the number of frames in which its silhouette shows what the others do not have.
    apart: Vec<usize>,
    /// For each camera the number of frames in which its silhouette lacks what the others show.
    pub(super) lacking: Vec<u32>,
}

impl Evidence {
    /// Whether a camera's silhouette shows what the others do not have in most frames.
    pub(super) fn is_apart(&self, place: usize, instants: &[Instant]) -> bool {
        2 * self.apart[place] > instants.len()
    }

    pub(super) fn new(
        rig: &Rig,
        instants: &[Instant],
        models: &[Model],
        hull: &GuideParams,
        reach: usize,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let mut evidence = Self { apart: vec![0; models.len()], lacking: vec![0; models.len()], ..Self::default() };
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
            guide.lacking.iter().for_each(|&place| evidence.lacking[usize::from(place)] += 1);
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

/// Which cameras' contours miss those of the others by far more than usual. `misses` are in pixels, by place.
pub(super) fn far_off(misses: &[Option<f64>]) -> Vec<bool> {
    let usual = median(&mut misses.iter().flatten().copied().collect::<Vec<f64>>()).unwrap_or(0.0);
    let limit = CONTRADICTS[0].max(CONTRADICTS[1] * usual);
    misses.iter().map(|miss| miss.is_some_and(|miss| miss > limit)).collect()
}
