//! How far local colours can be trusted to tell the sides apart.
//!
//! Before a cluttered backdrop pixels of the object may look like the backdrop: white soles under dark shoes, for example,
//! look like one of its bright spots. How often that happens is counted among the pixels that lie deep on each side. If a
//! share q of the object's pixels looks like background, then looking like background is a likelihood ratio of at most
//! 1 to q. Where all other pixels show that the sides' colours differ clearly, this does not apply: there it is the matte
//! that is wrong, not the colours.

use super::{
    colour_model::{CELL, Trust, WEIGHTS, WINDOW, gather},
    patch::Patch,
};
use crate::silhouette::{refill::refill, stored::UNITS};
use alloc::vec::Vec;

/// The deeper a pixel lies, the more certain is its side: a matte may be wrong by a few pixels.
const DEEP: Trust = Trust { from: 0.5, growth: 4.0, full: 6.0, to: 8.0 };
/// Weight of the assumption, and the share of confused pixels that is assumed, where few are counted. The weight is that
/// of one pixel in the middle cell of [`WINDOW`] at full depth.
const ASSUMED_WEIGHT: f32 = 9.0;
const ASSUMED_SHARE: f32 = 0.005;
/// Evidence of the sides' mean colours that is not clear yet. What exceeds it stays. The sides then differ by 4.9 standard
/// deviations.
const UNCLEAR: f32 = 12.0;
/// Added to variances of shares: there is always some noise.
const VARIANCE: f32 = 1e-3;

/// Weighted sums over pixels of one side: of all of them, and of those that look like their own side. Of the latter also
/// sums of the object's share and of its square.
type Sums = [f32; 4];

/// Limits of the evidence that local colours give, per cell.
#[derive(Debug, Default)]
pub(super) struct Confusion {
    columns: usize,
    /// Sums of background and object in every cell.
    sides: [Vec<Sums>; 2],
    /// Whether a cell has pixels whose evidence may be limited.
    near: Vec<bool>,
    /// Largest evidence against the object, and for it, in the cells that have such pixels.
    limits: Vec<[f32; 2]>,
}

impl Confusion {
    /// Distance from the contour, in pixels, up to which evidence is counted.
    pub const REACH: f32 = DEEP.to;

    /// Counts the pixels of both sides of a contour, given by the signed distance to it in 1/64 pixel, that look like the
    /// other side. `alphas` are the object's shares. `evidence` is the logarithm of each pixel's likelihood ratio, positive
    /// for the object, and 0 where its colour says nothing. Limits are found for pixels within `seen` pixels of the contour.
    pub fn count(&mut self, patch: &Patch, distance: &[i16], seen: f32, alphas: &[f32], evidence: &[f32]) {
        let (columns, rows) = (patch.width.div_ceil(CELL), patch.height.div_ceil(CELL));
        self.columns = columns;
        self.sides.iter_mut().for_each(|side| refill(side, columns * rows, [0.0; 4]));
        refill(&mut self.near, columns * rows, false);
        let mut room = [0.0; WEIGHTS];
        let weights = DEEP.weights(&mut room);
        for y in 0..patch.height {
            for x in 0..patch.width {
                let i = y * patch.width + x;
                let cell = y / CELL * columns + x / CELL;
                self.near[cell] |= f32::from(distance[i]).abs() <= seen * UNITS;
                let Some(&weight) = weights.get(usize::from(distance[i].unsigned_abs()) / 16) else { continue };
                if evidence[i].abs() > 0.0 {
                    let inside = distance[i] > 0;
                    let own = if inside == (evidence[i] > 0.0) { weight } else { 0.0 };
                    let terms = [weight, own, own * alphas[i], own * alphas[i] * alphas[i]];
                    let sums = &mut self.sides[usize::from(inside)][cell];
                    (0..terms.len()).for_each(|k| sums[k] += terms[k]);
                }
            }
        }
        let Self { sides, near, limits, .. } = self;
        refill(limits, columns * rows, [0.0; 2]);
        for (i, limit) in limits.iter_mut().enumerate().filter(|&(i, _)| near[i]) {
            let [background, object] = [0, 1].map(|side| gather(&sides[side], columns, rows, i, &WINDOW));
            let clear = means_evidence(&background, &object) - UNCLEAR;
            *limit = [object, background].map(|side| (-libm::logf(confused(&side))).max(clear));
        }
    }

    /// What remains of the evidence of a pixel for which limits were found.
    #[inline]
    pub fn limit(&self, x: usize, y: usize, evidence: f32) -> f32 {
        let [against, in_favour] = self.limits[y / CELL * self.columns + x / CELL];
        evidence.clamp(-against, in_favour)
    }
}

/// Share of the pixels that look like the other side.
fn confused(sums: &Sums) -> f32 {
    (sums[0] - sums[1] + ASSUMED_WEIGHT * ASSUMED_SHARE) / (sums[0] + ASSUMED_WEIGHT)
}

/// Evidence of the mean colours of both sides, by the pixels that look like their own side.
fn means_evidence(background: &Sums, object: &Sums) -> f32 {
    if background[1] <= 0.0 || object[1] <= 0.0 {
        return 0.0;
    }
    let mean = |sums: &Sums| sums[2] / sums[1];
    let variance = |sums: &Sums| (sums[3] / sums[1] - mean(sums) * mean(sums)).max(0.0) + VARIANCE;
    let gap = mean(object) - mean(background);
    gap * gap / (variance(background) + variance(object))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    const SIZE: usize = 64;
    /// Evidence of a pixel that looks like one of the mean colours.
    const SURE: f32 = 6.0;

    /// What remains of [`SURE`] against the object at a contour along the middle column, if every fifth of the object's
    /// pixels looks like background and shares of the object vary by ±`spread`.
    fn remaining(spread: f32) -> f32 {
        let coverage: Vec<u8> = (0..SIZE * SIZE).map(|i| if i % SIZE < SIZE / 2 { 255 } else { 0 }).collect();
        let rgb = vec![0; 3 * SIZE * SIZE];
        let patch = Patch::around(SIZE, SIZE, &rgb, &coverage).unwrap();
        let (mut distance, mut alphas) = (Vec::new(), Vec::new());
        for (x, y) in (0..patch.height).flat_map(|y| (0..patch.width).map(move |x| (x, y))) {
            let inside = x < SIZE / 2;
            let looks_inside = inside && !(x + 2 * y).is_multiple_of(5);
            let varied = if (x / 2 + y / 3).is_multiple_of(2) { spread } else { -spread };
            distance.push(((SIZE / 2) as i16 - x as i16) * 64 - 32);
            alphas.push(f32::from(u8::from(looks_inside)) + varied);
        }
        let evidence: Vec<f32> = alphas.iter().map(|&alpha| if alpha > 0.5 { SURE } else { -SURE }).collect();
        let mut confusion = Confusion::default();
        confusion.count(&patch, &distance, 4.0, &alphas, &evidence);
        -confusion.limit(SIZE / 2, SIZE / 2, -SURE)
    }

    #[test]
    fn colours_of_both_sides_are_little_evidence_unless_the_sides_differ_clearly() {
        let ratio = libm::logf(5.0);
        assert!((remaining(0.4) - ratio).abs() < 0.3, "cluttered: {} instead of {ratio}", remaining(0.4));
        assert!(remaining(0.05) >= SURE, "clear: {}", remaining(0.05));
    }
}
