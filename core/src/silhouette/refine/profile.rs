//! Evidence of the picture for the contour's place: costs of offsets along its normal.

use super::{colour_model::ColourModel, patch::Patch};
use crate::{
    math::min,
    silhouette::{refill::refill, stored::UNITS},
};
use alloc::vec::Vec;
use glam::Vec2;

/// Number of offsets: 0, ±1/4, … ±4 pixels.
pub(super) const OFFSETS: usize = 33;
/// Distance between offsets in pixels.
pub(super) const OFFSET_STEP: f32 = 0.25;
/// Number of samples of a profile: at 0, ±1/2, … ±6 pixels.
const SAMPLES: usize = 25;
const SAMPLE_STEP: f32 = 0.5;
/// Standard deviation of an edge in the picture: lens, demosaicing and interpolation.
const BLUR: f32 = 0.9;
/// Limit of a sample's squared error: what differs more is neither side's colour.
const MAX_SQUARED_ERROR: f32 = 0.25;
/// Share of a sample's precision that counts, because the noise of neighbouring pixels is correlated (demosaicing,
/// compression).
const INDEPENDENT: f32 = 0.3;
/// Limit of a colour model's precision.
const MAX_PRECISION: f32 = 200.0;
/// Cost of offsets outside the part of a profile that belongs to this contour.
const BLIND: f32 = 50.0;

/// Largest distance of a sample from the contour for which the expected share is tabulated, in quarters of a pixel.
const FARTHEST: usize = 48;

pub(super) type Costs = [f32; OFFSETS];

/// Offset of a state in pixels, positive outwards.
#[inline]
pub(super) fn offset(state: usize) -> f32 {
    (state as f32 - (OFFSETS / 2) as f32) * OFFSET_STEP
}

/// The object's share in the pixels around a contour.
#[derive(Debug)]
pub(super) struct Profiles<'a> {
    width: usize,
    height: usize,
    distance: &'a [i16],
    alpha: &'a [f32],
    precision: &'a [f32],
    /// Share of the object expected at a sample, by how far the contour is outwards from it in 1/4 pixel, from
    /// -[`FARTHEST`] on.
    edge: [f32; 2 * FARTHEST + 1],
}

impl<'a> Profiles<'a> {
    /// `planes` are buffers for each pixel's share and its precision.
    pub fn new(patch: &Patch, distance: &'a [i16], model: &ColourModel, planes: &'a mut [Vec<f32>; 2]) -> Self {
        let (w, h) = (patch.width, patch.height);
        let limit = ((SAMPLES / 2) as f32 * SAMPLE_STEP + 2.5) * UNITS;
        planes.iter_mut().for_each(|plane| refill(plane, patch.len(), 0.0));
        let [alpha, precision] = planes;
        for y in 0..h {
            for x in 0..w {
                let i = y * w + x;
                if f32::from(distance[i]).abs() < limit {
                    let local = model.at(x, y);
                    alpha[i] = local.alpha(patch.colour(x, y)).clamp(-0.3, 1.3);
                    precision[i] = local.j;
                }
            }
        }
        let mut edge = [0.0; 2 * FARTHEST + 1];
        for (i, edge) in edge.iter_mut().rev().enumerate() {
            let s = (i as f32 - FARTHEST as f32) * OFFSET_STEP / BLUR;
            *edge = 0.5 * libm::erfcf(s * core::f32::consts::FRAC_1_SQRT_2);
        }
        Self { width: w, height: h, distance, alpha, precision, edge }
    }

    /// The four pixels around a point of the patch and their bilinear weights.
    fn corners(&self, p: Vec2) -> Option<[(usize, f32); 4]> {
        let (w, h) = (self.width, self.height);
        if !(p.x >= 0.0 && p.y >= 0.0 && p.x <= (w - 1) as f32 && p.y <= (h - 1) as f32) {
            return None;
        }
        let (x, y) = ((p.x as usize).min(w - 2), (p.y as usize).min(h - 2));
        let (fx, fy) = (p.x - x as f32, p.y - y as f32);
        let i = y * w + x;
        Some([(i, (1.0 - fx) * (1.0 - fy)), (i + 1, fx * (1.0 - fy)), (i + w, (1.0 - fx) * fy), (i + w + 1, fx * fy)])
    }

    /// Share of the object and signed distance in pixels at a point of the patch.
    fn sample(&self, p: Vec2) -> Option<(f32, f32)> {
        let (mut alpha, mut distance) = (0.0, 0.0);
        for (i, weight) in self.corners(p)? {
            alpha += weight * self.alpha[i];
            distance += weight * f32::from(self.distance[i]);
        }
        Some((alpha, distance / UNITS))
    }

    /// Another signed distance, in pixels, at a point of the patch.
    pub fn interpolate(&self, distance: &[i16], p: Vec2) -> Option<f32> {
        let sum: f32 = self.corners(p)?.into_iter().map(|(i, weight)| weight * f32::from(distance[i])).sum();
        Some(sum / UNITS)
    }

    /// For each offset along the outward normal, minus the logarithm of the likelihood that the contour lies there.
    pub fn costs(&self, point: Vec2, normal: Vec2) -> Costs {
        let middle = SAMPLES / 2;
        let mut shares = [0.0f32; SAMPLES];
        let (mut first, mut last) = (middle + 1, middle);
        // Samples outwards and inwards until another piece of the contour is nearer.
        for outward in [true, false] {
            for k in 0..=middle {
                if outward && k == 0 {
                    continue;
                }
                let s = if outward { k as f32 } else { -(k as f32) } * SAMPLE_STEP;
                let Some((alpha, d)) = self.sample(point + normal * s) else { break };
                if (d + s).abs() > 1.0 + 0.15 * s.abs() {
                    break;
                }
                let i = if outward { middle + k } else { middle - k };
                shares[i] = alpha;
                if outward { last = i } else { first = i }
            }
        }
        let mut costs = [0.0; OFFSETS];
        if first > last {
            return costs;
        }
        let (x, y) = (point.x.max(0.0) as usize, point.y.max(0.0) as usize);
        let precision = self.precision[y.min(self.height - 1) * self.width + x.min(self.width - 1)];
        let scale = 0.5 * INDEPENDENT * SAMPLE_STEP * min(precision, MAX_PRECISION);
        let reach = |i: usize| (i as f32 - middle as f32) * SAMPLE_STEP;
        for (i, share) in (first..=last).zip(&shares[first..]) {
            // The first offset's distance from the sample, in quarters of a pixel. Vectors hold several offsets.
            let nearest = FARTHEST + 2 * middle - OFFSETS / 2 - 2 * i;
            for (sum, edge) in costs.iter_mut().zip(&self.edge[nearest..][..OFFSETS]) {
                let error = share - edge;
                *sum += min(error * error, MAX_SQUARED_ERROR);
            }
        }
        for (state, cost) in costs.iter_mut().enumerate() {
            let t = offset(state);
            *cost = if t < reach(first) || t > reach(last) { BLIND } else { scale * *cost };
        }
        costs
    }
}
