//! The contour's place from the picture and the matte together.

use super::{
    path::{self, Offset},
    profile::{Costs, OFFSETS, Profiles, offset},
    trace::Loops,
};
use crate::{
    math::{from_ordered, min, ordered, select},
    silhouette::refill::refill,
};
use alloc::vec::Vec;
use glam::Vec2;

/// Weights of the average of costs along the contour: neighbouring points have nearly the same offset.
const ALONG: [f32; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
/// Hardly any belief in the matte, for measuring its errors.
const FREE: Belief = Belief { bias: 0.0, precision: 0.05, max_cost: 2.0 };
/// The matte's errors are measured at points where the picture is more precise than 0.3 pixel (1/σ²).
const CLEAR: f32 = 10.0;
/// Smallest number of such points.
const MIN_CLEAR: usize = 100;
/// Spread of a matte that the picture cannot measure, in pixels.
const UNKNOWN_SPREAD: f32 = 1.0;
/// Errors of the picture's own contours in pixels: a common one, because edges are blurred in linear light and measured
/// in sRGB, and scatter. Neither is attributed to the matte.
const PICTURE_BIAS: f32 = 0.12;
const PICTURE_SPREAD: f32 = 0.2;
/// Smallest spread of a matte in pixels.
const MIN_SPREAD: f32 = 0.1;
/// Largest 1/σ² of a contour that only the matte gives (σ = half a pixel).
const UNSEEN_PRECISION: f32 = 4.0;
/// Limit of the matte's cost: pieces of a good matte may be wrong.
const MAX_COST: f32 = 6.0;

/// The true contour is believed to lie `bias` pixels outside the matte's, with σ = 1/√`precision` pixels.
#[derive(Debug, Clone, Copy)]
struct Belief {
    bias: f32,
    precision: f32,
    max_cost: f32,
}

/// What is known of the offset of each point of the contour's loops, along its normal.
#[derive(Debug, Default)]
pub(super) struct Fusion {
    normals: Vec<Vec2>,
    /// Costs of offsets by the picture.
    costs: Vec<Costs>,
    /// Offset of the matte's contour from each point; none beyond the patch's edge, where points do not move.
    matte: Vec<Option<f32>>,
    /// Variance of each point in pixel², once the loops are at their most probable places.
    pub variances: Vec<f32>,
    /// Errors of the matte, as ordered integers.
    errors: Vec<u32>,
    path: Path,
}

/// One loop's most probable offsets.
#[derive(Debug, Default)]
struct Path {
    ways: path::Ways,
    offsets: Vec<Offset>,
}

impl Fusion {
    /// Moves loops to their most probable places. `given` is the signed distance to the matte's contour.
    pub fn settle(&mut self, loops: &mut Loops, profiles: &Profiles, given: &[i16]) {
        self.collect(loops, profiles, given);
        let belief = self.belief(loops);
        let Self { normals, costs, matte, variances, path, .. } = self;
        refill(variances, costs.len(), 0.0);
        let Loops { points, ends } = loops;
        let mut start = 0;
        for &end in &*ends {
            path.find(&costs[start..end], &matte[start..end], &belief);
            for (i, offset) in (start..end).zip(&path.offsets) {
                if matte[i].is_some() {
                    points[i] += normals[i] * offset.value;
                }
                variances[i] = variance(offset, &costs[i]);
            }
            start = end;
        }
    }

    /// Collects costs along loops.
    fn collect(&mut self, loops: &Loops, profiles: &Profiles, given: &[i16]) {
        let Self { normals, costs, matte, .. } = self;
        let count = loops.points.len();
        refill(normals, count, Vec2::ZERO);
        refill(costs, count, [0.0; OFFSETS]);
        matte.clear();
        matte.extend(loops.points.iter().map(|&p| profiles.interpolate(given, p)));
        for range in loops.ranges() {
            let (points, normals) = (&loops.points[range.clone()], &mut normals[range.clone()]);
            find_normals(points, normals);
            along(|i| profiles.costs(points[i], normals[i]), &mut costs[range]);
        }
    }

    /// Median and spread of the matte's errors where the picture is clear.
    fn belief(&mut self, loops: &Loops) -> Belief {
        let Self { costs, matte, errors, path, .. } = self;
        errors.clear();
        for range in loops.ranges() {
            path.find(&costs[range.clone()], &matte[range.clone()], &FREE);
            for (offset, matte) in path.offsets.iter().zip(&matte[range]) {
                if let Some(matte) = matte
                    && offset.precision > CLEAR
                {
                    errors.push(ordered(offset.value - matte));
                }
            }
        }
        if errors.len() < MIN_CLEAR {
            return Belief { bias: 0.0, precision: 1.0 / (UNKNOWN_SPREAD * UNKNOWN_SPREAD), max_cost: MAX_COST };
        }
        let bias = median(errors);
        errors.iter_mut().for_each(|e| *e = ordered((from_ordered(*e) - bias).abs()));
        // Of a normal distribution the median error is 0.674 σ.
        let spread = median(errors) / 0.674;
        let variance = spread * spread - PICTURE_SPREAD * PICTURE_SPREAD;
        let precision = 1.0 / variance.max(MIN_SPREAD * MIN_SPREAD);
        // A small bias may be the picture's own, a large one is the matte's.
        let share = ((bias.abs() - PICTURE_BIAS) / (2.0 * PICTURE_BIAS)).clamp(0.0, 1.0);
        Belief { bias: bias * share, precision, max_cost: MAX_COST }
    }
}

impl Path {
    /// Finds the offsets of a loop from the picture's costs and the belief in the matte.
    fn find(&mut self, costs: &[Costs], matte: &[Option<f32>], belief: &Belief) {
        let both = |i: usize| {
            let mut costs = costs[i];
            let expected = matte[i].unwrap_or(0.0) + belief.bias;
            for (state, cost) in costs.iter_mut().enumerate() {
                let error = offset(state) - expected;
                *cost += min(0.5 * error * error * belief.precision, belief.max_cost);
            }
            costs
        };
        path::offsets(costs.len(), both, &mut self.ways, &mut self.offsets);
    }
}

/// Variance of an offset. A matte that is precise where the picture confirms it need not be so where it does not.
fn variance(offset: &Offset, picture: &Costs) -> f32 {
    let seen = path::precision(picture, offset.value) / UNSEEN_PRECISION;
    1.0 / offset.precision.max(1e-4) + 1.0 / (UNSEEN_PRECISION * (1.0 + seen * seen))
}

/// The median of numbers as ordered integers.
fn median(values: &mut [u32]) -> f32 {
    from_ordered(select(values, values.len() / 2))
}

/// Outward unit normals of a closed loop that has the object on its right-hand side.
fn find_normals(points: &[Vec2], out: &mut [Vec2]) {
    let n = points.len();
    let at = |i: usize| points[i % n];
    for (i, out) in out.iter_mut().enumerate() {
        let along = at(i + 2) - at(i + 2 * n - 2) + (at(i + 1) - at(i + n - 1)) * 2.0;
        *out = Vec2::new(along.y, -along.x).normalize_or_zero();
    }
}

/// Averages costs along a closed loop. Each point's own costs are computed when they are first needed, so that only
/// those of a few points are held.
fn along(costs: impl Fn(usize) -> Costs, out: &mut [Costs]) {
    let (n, reach) = (out.len(), ALONG.len() / 2);
    let total: f32 = ALONG.iter().sum();
    let place = |i: usize| (i + reach * n - reach) % n;
    let mut window: [Costs; ALONG.len()] = core::array::from_fn(|k| costs(place(k)));
    for (i, out) in out.iter_mut().enumerate() {
        if i > 0 {
            window.rotate_left(1);
            window[ALONG.len() - 1] = costs(place(i + ALONG.len() - 1));
        }
        for (weight, from) in ALONG.into_iter().zip(&window) {
            (0..OFFSETS).for_each(|state| out[state] += weight / total * from[state]);
        }
    }
}
