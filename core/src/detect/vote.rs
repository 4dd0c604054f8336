//! Eq. 1: the sample on a pixel's ray that most neighbouring views support with a peak of their own curve.

use super::sweep::{TILE, TILE_PIXELS};
use alloc::{vec, vec::Vec};

/// How curves of scores become one depth.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct VoteParams {
    /// Standard deviation, in samples, of the Gaussian that smooths each view's curve (§4.1); 0 for none.
    pub smoothing: f32,
    /// Count a view's score only where its curve peaks (the local-maximum rule); off sums plain scores.
    pub local_maximum: bool,
    /// Standard deviation, in samples, of the kernel that spreads a peak to its neighbourhood (Parzen window);
    /// 0 is eq. 1 as printed, where peaks one sample apart do not support each other.
    pub spread: f32,
    /// Pixels add the votes of their neighbours up to this far on the same sheet to their own, so that what one
    /// window leaves open its surroundings decide; 0 for none, as in eq. 1.
    pub agreement_radius: u32,
}

/// Scores of a tile: for every neighbour and plane, one score a pixel.
#[derive(Debug, Default)]
pub struct Curves {
    planes: usize,
    /// `[neighbour][plane][pixel]`.
    scores: Vec<[f32; TILE_PIXELS]>,
    smooth: Vec<[f32; TILE_PIXELS]>,
    /// `[plane][pixel]`: support gathered from all neighbours.
    votes: Vec<[f32; TILE_PIXELS]>,
}

impl Curves {
    /// Makes room for `neighbours` curves over `planes` planes.
    pub fn reset(&mut self, neighbours: usize, planes: usize) {
        self.planes = planes;
        self.scores.resize(neighbours * planes, [0.0; TILE_PIXELS]);
        self.smooth.resize(planes, [0.0; TILE_PIXELS]);
        self.votes.clear();
        self.votes.resize(planes, [0.0; TILE_PIXELS]);
    }

    /// Where the scores of a neighbour on a plane go.
    pub fn scores_mut(&mut self, neighbour: usize, plane: usize) -> &mut [f32; TILE_PIXELS] {
        &mut self.scores[neighbour * self.planes + plane]
    }

    /// Gathers all neighbours' support.
    pub fn vote(&mut self, neighbours: usize, params: &VoteParams) {
        let kernel = gaussian(params.smoothing);
        for j in 0..neighbours {
            let curve = &self.scores[j * self.planes..][..self.planes];
            smooth(curve, &kernel, &mut self.smooth);
            if params.local_maximum {
                spread_peaks(&self.smooth, params.spread, &mut self.votes);
            } else {
                for (votes, curve) in self.votes.iter_mut().zip(&self.smooth) {
                    for (v, c) in votes.iter_mut().zip(curve) {
                        *v += c;
                    }
                }
            }
        }
    }

    /// Replaces every pixel's votes by the mean over the searched pixels round it, within the tile.
    pub fn agree(&mut self, radius: usize, searched: &[bool; TILE_PIXELS]) {
        let weight = searched.map(|s| if s { 1.0 } else { 0.0 });
        let counts = box_sum(&weight, radius);
        for votes in &mut self.votes {
            for (v, w) in votes.iter_mut().zip(&weight) {
                *v *= w;
            }
            *votes = box_sum(votes, radius);
            for (v, n) in votes.iter_mut().zip(&counts) {
                *v /= n.max(1.0);
            }
        }
    }

    /// The best supported plane among `first..=last` for a pixel: its position, fractional where `refine` asks, and
    /// the support, the fidelity of §4.1.
    pub fn best(&self, pixel: usize, first: usize, last: usize, refine: bool) -> (f32, f32) {
        let (mut best, mut support) = (first, f32::NEG_INFINITY);
        for i in first..=last {
            if self.votes[i][pixel] > support {
                (best, support) = (i, self.votes[i][pixel]);
            }
        }
        let mut position = best as f32;
        if refine && best > 0 && best + 1 < self.planes {
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

/// Convolves along the planes; beyond the ends the end's value goes on.
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
fn box_sum(values: &[f32; TILE_PIXELS], radius: usize) -> [f32; TILE_PIXELS] {
    let (mut rows, mut out) = ([0.0; TILE_PIXELS], [0.0; TILE_PIXELS]);
    for y in 0..TILE {
        for from in y.saturating_sub(radius)..(y + radius + 1).min(TILE) {
            for x in 0..TILE {
                rows[y * TILE + x] += values[from * TILE + x];
            }
        }
    }
    for row in 0..TILE {
        for x in 0..TILE {
            let (from, to) = (x.saturating_sub(radius), (x + radius + 1).min(TILE));
            out[row * TILE + x] = rows[row * TILE + from..row * TILE + to].iter().fold(0.0, |s: f32, v| s + v);
        }
    }
    out
}

/// Adds every positive peak of a curve to the votes, spread by the kernel round its sub-sample position.
fn spread_peaks(curve: &[[f32; TILE_PIXELS]], spread: f32, votes: &mut [[f32; TILE_PIXELS]]) {
    let scale = if spread > 0.0 { 0.5 / (spread * spread) } else { 0.0 };
    let reach = libm::ceilf(2.5 * spread) as usize;
    for i in 1..curve.len() - 1 {
        for p in 0..TILE_PIXELS {
            let (before, peak, after) = (curve[i - 1][p], curve[i][p], curve[i + 1][p]);
            if !(peak > 0.0 && peak > before && peak > after) {
                continue;
            }
            if reach == 0 {
                votes[i][p] += peak;
                continue;
            }
            let offset = vertex(before, peak, after);
            for k in i.saturating_sub(reach)..=(i + reach).min(curve.len() - 1) {
                let distance = k as f32 - i as f32 - offset;
                votes[k][p] += peak * bell(distance * distance * scale);
            }
        }
    }
}

/// exp(-x) for x ≥ 0 to within 1 %: (1 + x/8)⁻⁸, cheap and the same everywhere.
#[inline]
fn bell(x: f32) -> f32 {
    let y = 1.0 + x * 0.125;
    let y = y * y;
    let y = y * y;
    1.0 / (y * y)
}

/// Vertex of the parabola through three equidistant values, relative to the middle one, which is the largest.
#[inline]
fn vertex(before: f32, peak: f32, after: f32) -> f32 {
    let curvature = before - 2.0 * peak + after;
    if curvature < 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}
