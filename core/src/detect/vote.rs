//! Eq. 1 (§4.1): selects the depth hypothesis of a pixel that has the most support. A neighbouring view supports a
//! hypothesis if the view's own correlation curve has a peak there.

use super::sweep::{EMPTY, MAX_RADIUS, TILE, TILE_PIXELS, windows};
use crate::math::{max, sqrt};
use alloc::{vec, vec::Vec};

/// Parameters of the vote: how correlation curves determine the depth.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct VoteParams {
    /// Smooths each view's curve by a Gaussian with this standard deviation, in hypotheses (§4.1).
    pub smoothing: Option<f32>,
    /// What a view's curve adds to the support of a hypothesis.
    pub support: Support,
    /// Averages the votes for a hypothesis over the pixels within this distance, in pixels, so that neighbouring pixels
    /// resolve ambiguities of a single window. At most 4. Not part of eq. 1.
    pub agreement_radius: Option<u32>,
}

/// What a view's curve adds to the support of a hypothesis.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Support {
    /// Its score. This is eq. 1 without the local-maximum rule, for comparison.
    Scores,
    /// Its score if the curve has a peak there: eq. 1 as printed. Peaks that are one hypothesis apart do not support
    /// each other.
    Peaks,
    /// Its peaks, spread to nearby hypotheses by a Gaussian kernel with this standard deviation, in hypotheses.
    /// Vogiatzis, Hernández, Torr and Cipolla (Multiview Stereo via Volumetric Graph-Cuts and Occlusion Robust
    /// Photo-Consistency, PAMI 2007) spread peaks by a Parzen window in this way.
    SpreadPeaks(f32),
}

impl Support {
    /// Standard deviation of the kernel that spreads peaks, in hypotheses. `None` if peaks are not spread.
    pub(super) fn width(self) -> Option<f32> {
        match self {
            Self::SpreadPeaks(sigma) => Some(sigma).filter(|&sigma| sigma > 0.0),
            Self::Peaks | Self::Scores => None,
        }
    }
}

/// Correlation curves of a tile: the scores of one neighbour on all hypotheses, and the votes of all neighbours so far.
#[derive(Debug, Default)]
pub struct Curves {
    /// `[hypothesis][pixel]`: the scores of a neighbour.
    scores: Vec<[f32; TILE_PIXELS]>,
    /// The smoothed scores. Not used without smoothing.
    smooth: Vec<[f32; TILE_PIXELS]>,
    /// `[hypothesis][pixel]`: the sum of the support of all neighbours.
    votes: Vec<[f32; TILE_PIXELS]>,
    /// Weights of the smoothing, from the centre outward.
    gaussian: Vec<f32>,
    /// The kernel that spreads peaks.
    spread: Spread,
}

impl Curves {
    /// Computes the kernels for the given parameters.
    pub fn tune(&mut self, params: &VoteParams) {
        self.gaussian = gaussian(params.smoothing.unwrap_or(0.0));
        self.spread = Spread::new(params.support.width().unwrap_or(0.0));
    }

    /// Starts a new tile with `count` hypotheses.
    pub fn reset(&mut self, count: usize) {
        self.scores.resize(count, [0.0; TILE_PIXELS]);
        if self.gaussian.len() > 1 {
            self.smooth.resize(count, [0.0; TILE_PIXELS]);
        }
        self.votes.clear();
        self.votes.resize(count, [0.0; TILE_PIXELS]);
    }

    /// The scores of a neighbour on each hypothesis, to be overwritten.
    pub fn scores_mut(&mut self) -> &mut [[f32; TILE_PIXELS]] {
        &mut self.scores
    }

    /// Adds the support of the neighbour whose scores have been written.
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

    /// Replaces the votes of every pixel by their mean over the searched pixels around it, within the tile.
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

    /// The hypothesis among `first..=last` with the most support: its index, which is fractional with `refine`, and its
    /// support, which is the fidelity of §4.1.
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

/// Standard deviation of the best hypothesis, in hypotheses, from its support per view, the number of independent peaks
/// in it and the kind of support.
///
/// With a kernel of width w, a peak of height s that is δ hypotheses away adds s exp(-δ² / 2w²) to the support, and low
/// scores come with scattered peaks. Both lower the support q: 2w² (1 - q) / q is about the mean square of the peaks'
/// distances from the best hypothesis. The best hypothesis is the mean of the peaks that support it, which are a share q
/// of all. Peaks are nearer to their own mean than to the truth. To make up for that, one peak less is counted (Bessel's
/// correction).
///
/// If peaks are not spread, w is taken as 1, and the result is a rough value.
pub fn deviation(support: f32, independent: f32, kind: Support) -> f32 {
    // Beyond these the support says no more: fewer than one view in twenty, and a perfect match.
    let q = support.clamp(0.05, 0.97);
    let width = kind.width().unwrap_or(1.0);
    width * sqrt(2.0 * (1.0 - q) / (q * q * max(independent - 1.0, 1.0)))
}

/// One half of a normalised Gaussian, from the centre to two standard deviations.
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

/// Convolves along the hypotheses. The values at the ends are repeated beyond them.
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

/// Sums over a square of pixels around each pixel, clipped at the tile's edges.
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

/// The weights of a kernel around a peak, tabulated by the sub-sample position of the peak.
#[derive(Debug, Default)]
struct Spread {
    /// Number of hypotheses on either side that a peak reaches.
    reach: usize,
    /// `[position][hypothesis]`.
    weights: Vec<[f32; Spread::WIDEST]>,
}

impl Spread {
    /// Number of sub-sample positions in the table.
    const PLACES: usize = 32;
    /// Largest number of hypotheses that a peak reaches.
    const WIDEST: usize = 16;

    /// A Gaussian with standard deviation `sigma`, in hypotheses. With 0, peaks are not spread.
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

    /// Adds all positive peaks of a curve to the votes, spread by the kernel around their sub-sample positions.
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
                // Conversion to a signed integer is a single instruction, unlike conversion to `usize`.
                let weights = &self.weights[(place as i32 as usize).min(Self::PLACES)];
                let first = i.saturating_sub(self.reach);
                let last = (i + self.reach).min(curve.len() - 1);
                for (votes, weight) in votes[first..=last].iter_mut().zip(&weights[first + self.reach - i..]) {
                    votes[p] += peaks[p] * weight;
                }
            }
        }
    }
}

/// The indices of the bytes that are 1, in ascending order. Fast if most bytes are 0.
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

/// Position of the vertex of the parabola through three equidistant values, relative to the middle one, which is the
/// largest.
#[inline]
fn vertex(before: f32, peak: f32, after: f32) -> f32 {
    let curvature = before - 2.0 * peak + after;
    if curvature < 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}
