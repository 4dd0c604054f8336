//! Frequencies of colours.

use super::colours::{HUE, LIGHT};
use alloc::{vec, vec::Vec};

/// Smallest probability of a bin, so that the likelihoods of colours that were never seen stay finite.
pub(super) const FLOOR: f32 = 1e-6;

/// How often each colour occurs, smoothed over about one bin to each side.
pub(super) struct Histogram {
    /// Weights of all bins.
    pub weights: Vec<f32>,
    /// Their sum.
    pub total: f32,
}

impl Histogram {
    /// Counts colours, given by their bins and weights.
    pub fn new(colours: impl Iterator<Item = (usize, f32)>) -> Self {
        let mut weights = vec![0.0; LIGHT * HUE * HUE];
        colours.for_each(|(bin, weight)| weights[bin] += weight);
        Self::smoothed(weights)
    }

    /// The histogram of weights that are spread to neighbouring bins.
    fn smoothed(mut weights: Vec<f32>) -> Self {
        let mut line = [0.0; HUE];
        for (size, stride) in [(HUE, 1), (HUE, HUE), (LIGHT, HUE * HUE)] {
            for first in (0..weights.len() / size).map(|k| k / stride * stride * size + k % stride) {
                // A window of 1 2 1 twice.
                for _ in 0..2 {
                    (0..size).for_each(|k| line[k] = weights[first + k * stride]);
                    for k in 0..size {
                        let around = line[k.saturating_sub(1)] + line[(k + 1).min(size - 1)];
                        weights[first + k * stride] = 0.25 * around + 0.5 * line[k];
                    }
                }
            }
        }
        let total = weights.iter().sum();
        Self { weights, total }
    }

    /// Counts the colours of pixels, given their bins.
    pub fn of_pixels(pixels: impl Iterator<Item = usize>, bin: impl Fn(usize) -> usize) -> Self {
        Self::new(pixels.map(|i| (bin(i), 1.0)))
    }

    /// Counts the colours of the object and of all other pixels.
    pub fn of_sides(object: &[bool], bin: impl Fn(usize) -> usize) -> [Self; 2] {
        [true, false].map(|side| Self::of_pixels((0..object.len()).filter(|&i| object[i] == side), &bin))
    }

    /// Probability of a bin.
    pub fn probability(&self, bin: usize) -> f32 {
        if self.total > 0.0 { self.weights[bin] / self.total } else { 0.0 }
    }

    /// Logarithm of each bin's likelihood ratio to another histogram, clamped to plus and minus `clamp`.
    pub fn ratios(&self, other: &Self, clamp: f32) -> Vec<f32> {
        let ratio = |bin| {
            let (own, others) = (self.probability(bin), other.probability(bin));
            if own == 0.0 && others == 0.0 { 0.0 } else { libm::logf((own + FLOOR) / (others + FLOOR)) }
        };
        (0..self.weights.len()).map(|bin| ratio(bin).clamp(-clamp, clamp)).collect()
    }
}
