//! The contour's place from the picture and the matte together.

use super::{
    path::{self, Offset},
    profile::{Costs, OFFSETS, Profiles, offset},
};
use crate::math::min;
use alloc::{vec, vec::Vec};
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

/// The contour's loops, and for each of their points the costs of offsets along its normal.
pub(super) struct Fusion {
    loops: Vec<Loop>,
}

struct Loop {
    points: Vec<Vec2>,
    normals: Vec<Vec2>,
    costs: Vec<Costs>,
    /// Offset of the matte's contour from each point; none beyond the patch's edge, where points do not move.
    matte: Vec<Option<f32>>,
}

impl Fusion {
    /// Collects costs along loops. `given` is the signed distance to the matte's contour.
    pub fn new(loops: Vec<Vec<Vec2>>, profiles: &Profiles, given: &[i16]) -> Self {
        let make = |points: Vec<Vec2>| {
            let normals = normals(&points);
            let costs: Vec<Costs> = points.iter().zip(&normals).map(|(&p, &n)| profiles.costs(p, n)).collect();
            let matte = points.iter().map(|&p| profiles.interpolate(given, p)).collect();
            Loop { costs: along(&costs), points, normals, matte }
        };
        Self { loops: loops.into_iter().map(make).collect() }
    }

    /// The loops at their most probable places, and the variance of each of their points in pixel².
    pub fn most_probable(&self) -> (Vec<Vec<Vec2>>, Vec<Vec<f32>>) {
        let belief = self.belief();
        let (mut moved, mut variances) = (Vec::new(), Vec::new());
        for part in &self.loops {
            let offsets = part.offsets(&belief);
            let step = |i: usize| part.points[i] + part.normals[i] * offsets[i].value;
            moved.push((0..part.points.len()).map(|i| part.matte[i].map_or(part.points[i], |_| step(i))).collect());
            variances.push(offsets.iter().zip(&part.costs).map(|(o, costs)| variance(o, costs)).collect());
        }
        (moved, variances)
    }

    /// Median and spread of the matte's errors where the picture is clear.
    fn belief(&self) -> Belief {
        let mut errors: Vec<f32> = Vec::new();
        for part in &self.loops {
            for (offset, matte) in part.offsets(&FREE).iter().zip(&part.matte) {
                if let Some(matte) = matte
                    && offset.precision > CLEAR
                {
                    errors.push(offset.value - matte);
                }
            }
        }
        if errors.len() < MIN_CLEAR {
            return Belief { bias: 0.0, precision: 1.0 / (UNKNOWN_SPREAD * UNKNOWN_SPREAD), max_cost: MAX_COST };
        }
        let bias = median(&mut errors);
        errors.iter_mut().for_each(|e| *e = (*e - bias).abs());
        // Of a normal distribution the median error is 0.674 σ.
        let spread = median(&mut errors) / 0.674;
        let variance = spread * spread - PICTURE_SPREAD * PICTURE_SPREAD;
        let precision = 1.0 / variance.max(MIN_SPREAD * MIN_SPREAD);
        // A small bias may be the picture's own, a large one is the matte's.
        let share = ((bias.abs() - PICTURE_BIAS) / (2.0 * PICTURE_BIAS)).clamp(0.0, 1.0);
        Belief { bias: bias * share, precision, max_cost: MAX_COST }
    }
}

impl Loop {
    fn offsets(&self, belief: &Belief) -> Vec<Offset> {
        let mut costs = self.costs.clone();
        for (costs, matte) in costs.iter_mut().zip(&self.matte) {
            let expected = matte.unwrap_or(0.0) + belief.bias;
            for (state, cost) in costs.iter_mut().enumerate() {
                let error = offset(state) - expected;
                *cost += min(0.5 * error * error * belief.precision, belief.max_cost);
            }
        }
        path::offsets(&costs)
    }
}

/// Variance of an offset. A matte that is precise where the picture confirms it need not be so where it does not.
fn variance(offset: &Offset, picture: &Costs) -> f32 {
    let seen = path::precision(picture, offset.value) / UNSEEN_PRECISION;
    1.0 / offset.precision.max(1e-4) + 1.0 / (UNSEEN_PRECISION * (1.0 + seen * seen))
}

fn median(values: &mut [f32]) -> f32 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f32::total_cmp).1
}

/// Outward unit normals of a closed loop that has the object on its right-hand side.
fn normals(points: &[Vec2]) -> Vec<Vec2> {
    let n = points.len();
    let at = |i: usize| points[i % n];
    let normal = |i: usize| {
        let along = at(i + 2) - at(i + 2 * n - 2) + (at(i + 1) - at(i + n - 1)) * 2.0;
        Vec2::new(along.y, -along.x).normalize_or_zero()
    };
    (0..n).map(normal).collect()
}

/// Averages costs along a closed loop.
fn along(costs: &[Costs]) -> Vec<Costs> {
    let (n, reach) = (costs.len(), ALONG.len() / 2);
    let total: f32 = ALONG.iter().sum();
    let mut out = vec![[0.0; OFFSETS]; n];
    for (i, out) in out.iter_mut().enumerate() {
        for (k, weight) in ALONG.into_iter().enumerate() {
            let from = &costs[(i + k + reach * n - reach) % n];
            (0..OFFSETS).for_each(|state| out[state] += weight / total * from[state]);
        }
    }
    out
}
