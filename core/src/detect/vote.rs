//! Eq. 1: the sample on a pixel's ray that most neighbouring views support with a peak of their own curve.

use super::sweep::{EMPTY, MAX_RADIUS, TILE, TILE_PIXELS, windows};
use crate::math::max;
use alloc::{vec, vec::Vec};

/// How curves of scores become one depth.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct VoteParams {
    /// Standard deviation, in samples, of the Gaussian that smooths each view's curve (§4.1), if it is smoothed.
    pub smoothing: Option<f32>,
    /// What a view's curve adds to the support of a sample.
    pub support: Support,
    /// Pixels add the votes of their neighbours up to this far on the same depth hypothesis to their own, so that the
    /// surroundings decide what a single window leaves open. Not in eq. 1. At most 4.
    pub agreement_radius: Option<u32>,
}

/// What a view's curve adds to the support of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Support {
    /// Its score at the sample: eq. 1 without the local-maximum rule, for comparison.
    Scores,
    /// Its score, but only where the curve peaks: eq. 1 as printed. Peaks one sample apart do not support each other.
    Peaks,
    /// Its peaks, spread to the samples around them by a Gaussian kernel of this standard deviation, in samples (Vogiatzis,
    /// Hernández, Torr, Cipolla: Multiview Stereo via Volumetric Graph-Cuts and Occlusion Robust Photo-Consistency, PAMI
    /// 2007, spread peaks by a Parzen window).
    SpreadPeaks(f32),
}

/// Scores of a tile: one neighbour's on every hypothesis, and what all have voted.
#[derive(Debug, Default)]
pub struct Curves {
    /// `[hypothesis][pixel]`: a neighbour's scores.
    scores: Vec<[f32; TILE_PIXELS]>,
    /// The same smoothed, unless they are taken as they are.
    smooth: Vec<[f32; TILE_PIXELS]>,
    /// `[hypothesis][pixel]`: support gathered from all neighbours.
    votes: Vec<[f32; TILE_PIXELS]>,
    /// Weights of the smoothing.
    gaussian: Vec<f32>,
    /// How a peak spreads.
    spread: Spread,
}

impl Curves {
    /// Prepares for the scores that `params` asks for.
    pub fn tune(&mut self, params: &VoteParams) {
        let spread = match params.support {
            Support::SpreadPeaks(sigma) => sigma,
            Support::Peaks | Support::Scores => 0.0,
        };
        (self.gaussian, self.spread) = (gaussian(params.smoothing.unwrap_or(0.0)), Spread::new(spread));
    }

    /// Makes room for a tile with `hypotheses` hypotheses.
    pub fn reset(&mut self, hypotheses: usize) {
        self.scores.resize(hypotheses, [0.0; TILE_PIXELS]);
        if self.gaussian.len() > 1 {
            self.smooth.resize(hypotheses, [0.0; TILE_PIXELS]);
        }
        self.votes.clear();
        self.votes.resize(hypotheses, [0.0; TILE_PIXELS]);
    }

    /// Where the scores of a neighbour on each hypothesis go.
    pub fn scores_mut(&mut self) -> &mut [[f32; TILE_PIXELS]] {
        &mut self.scores
    }

    /// Adds the support of the neighbour whose scores are there.
    #[inline(always)]
    pub fn vote(&mut self, params: &VoteParams) {
        let curves = if self.gaussian.len() > 1 {
            smooth(&self.scores, &self.gaussian, &mut self.smooth);
            &self.smooth
        } else {
            &self.scores
        };
        if params.support != Support::Scores {
            self.spread.peaks(curves, &mut self.votes);
        } else {
            for (votes, curve) in self.votes.iter_mut().zip(curves) {
                for (v, c) in votes.iter_mut().zip(curve) {
                    *v += c;
                }
            }
        }
    }

    /// Replaces every pixel's votes by the mean over the searched pixels round it, within the tile.
    #[inline(always)]
    pub fn agree(&mut self, radius: usize, searched: &[bool; TILE_PIXELS]) {
        let weight = searched.map(|s| if s { 1.0 } else { 0.0 });
        let counts = box_sum(&weight, radius);
        for votes in &mut self.votes {
            for (v, w) in votes.iter_mut().zip(&weight) {
                *v *= w;
            }
            *votes = box_sum(votes, radius);
            for (v, n) in votes.iter_mut().zip(&counts) {
                *v /= max(*n, 1.0);
            }
        }
    }

    /// The best supported hypothesis among `first..=last` for a pixel: its position, fractional where `refine` asks, and
    /// the support, the fidelity of §4.1.
    pub fn best(&self, pixel: usize, first: usize, last: usize, refine: bool) -> (f32, f32) {
        let (mut best, mut support) = (first, f32::NEG_INFINITY);
        for i in first..=last {
            if self.votes[i][pixel] > support {
                (best, support) = (i, self.votes[i][pixel]);
            }
        }
        let mut position = best as f32;
        if refine && best > 0 && best + 1 < self.votes.len() {
            position += vertex(self.votes[best - 1][pixel], support, self.votes[best + 1][pixel]);
        }
        (position, support)
    }
}

/// One half of a normalised Gaussian, centre first, out to two standard deviations.
fn gaussian(sigma: f32) -> Vec<f32> {
    if sigma <= 0.0 {
        return vec![1.0];
    }
    let reach = libm::ceilf(2.0 * sigma) as usize;
    let mut half: Vec<f32> = (0..=reach).map(|k| libm::expf(-0.5 * (k * k) as f32 / (sigma * sigma))).collect();
    let total = half[0] + 2.0 * half[1..].iter().fold(0.0, |s, v| s + v);
    half.iter_mut().for_each(|v| *v /= total);
    half
}

/// Convolves along the hypotheses; beyond the ends the end's value goes on.
#[inline(always)]
fn smooth(curve: &[[f32; TILE_PIXELS]], kernel: &[f32], out: &mut [[f32; TILE_PIXELS]]) {
    let last = curve.len() - 1;
    for i in 0..curve.len() {
        for p in 0..TILE_PIXELS {
            out[i][p] = curve[i][p] * kernel[0];
        }
        for (k, &weight) in kernel.iter().enumerate().skip(1) {
            let (before, after) = (&curve[i.saturating_sub(k)], &curve[(i + k).min(last)]);
            for p in 0..TILE_PIXELS {
                out[i][p] += (before[p] + after[p]) * weight;
            }
        }
    }
}

/// Sums over a square of pixels, cut at the tile's edges.
#[inline(always)]
fn box_sum(values: &[f32; TILE_PIXELS], radius: usize) -> [f32; TILE_PIXELS] {
    debug_assert!(radius <= MAX_RADIUS);
    let (rows, mut out) = (values.as_chunks::<TILE>().0, [0.0; TILE_PIXELS]);
    for (y, out) in out.as_chunks_mut::<TILE>().0.iter_mut().enumerate() {
        let mut columns = EMPTY;
        let middle: &mut [f32; TILE] = columns[radius..].first_chunk_mut().expect("a row has a margin on both sides");
        for row in &rows[y.saturating_sub(radius)..(y + radius + 1).min(TILE)] {
            for x in 0..TILE {
                middle[x] += row[x];
            }
        }
        *out = windows(&columns, radius);
    }
    out
}

/// A kernel's weights round a peak, for each of its places between two samples.
#[derive(Debug, Default)]
struct Spread {
    /// Hypotheses on either side that a peak reaches.
    reach: usize,
    /// `[place][hypothesis]`.
    weights: Vec<[f32; Spread::WIDEST]>,
}

impl Spread {
    /// Places between two samples that are told apart.
    const PLACES: usize = 32;
    /// Most hypotheses that a peak reaches.
    const WIDEST: usize = 16;

    /// Of standard deviation `sigma`, in samples; 0 leaves a peak where it is.
    fn new(sigma: f32) -> Self {
        if sigma <= 0.0 {
            return Self { reach: 0, weights: vec![[1.0; Self::WIDEST]; Self::PLACES + 1] };
        }
        let reach = (libm::ceilf(2.5 * sigma) as usize).min(Self::WIDEST / 2 - 1);
        let weight = |place: usize, k: usize| {
            let distance = k as f32 - reach as f32 - (place as f32 / Self::PLACES as f32 - 0.5);
            libm::expf(-0.5 * distance * distance / (sigma * sigma))
        };
        let row = |place| core::array::from_fn(|k| if k <= 2 * reach { weight(place, k) } else { 0.0 });
        Self { reach, weights: (0..=Self::PLACES).map(row).collect() }
    }

    /// Adds every positive peak of a curve to the votes, spread by the kernel round its sub-sample position.
    #[inline(always)]
    fn peaks(&self, curve: &[[f32; TILE_PIXELS]], votes: &mut [[f32; TILE_PIXELS]]) {
        for i in 1..curve.len() - 1 {
            let (before, peaks, after) = (&curve[i - 1], &curve[i], &curve[i + 1]);
            let mut is_peak = [0u8; TILE_PIXELS];
            for p in 0..TILE_PIXELS {
                is_peak[p] = u8::from((peaks[p] > 0.0) & (peaks[p] > before[p]) & (peaks[p] > after[p]));
            }
            for p in ones(&is_peak) {
                let offset = vertex(before[p], peaks[p], after[p]);
                let place = (offset + 0.5) * Self::PLACES as f32 + 0.5;
                let weights = &self.weights[(place as usize).min(Self::PLACES)];
                let first = i.saturating_sub(self.reach);
                let last = (i + self.reach).min(curve.len() - 1);
                for (votes, weight) in votes[first..=last].iter_mut().zip(&weights[first + self.reach - i..]) {
                    votes[p] += peaks[p] * weight;
                }
            }
        }
    }
}

/// Where bytes are one rather than zero, in order: few are.
#[inline(always)]
fn ones(bytes: &[u8; TILE_PIXELS]) -> impl Iterator<Item = usize> {
    const WORD: usize = 8;
    bytes.as_chunks::<WORD>().0.iter().enumerate().flat_map(|(i, word)| {
        let mut left = u64::from_le_bytes(*word);
        core::iter::from_fn(move || {
            let next = (left != 0).then(|| i * WORD + left.trailing_zeros() as usize / WORD);
            left &= left.wrapping_sub(1);
            next
        })
    })
}

/// Vertex of the parabola through three equidistant values, relative to the middle one, which is the largest.
#[inline]
fn vertex(before: f32, peak: f32, after: f32) -> f32 {
    let curvature = before - 2.0 * peak + after;
    if curvature < 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}
