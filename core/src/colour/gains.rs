//! One gain per camera and channel, so that cameras that see the same surface agree on its colour.

use super::candidate::Candidate;
use crate::{
    math::{from_ordered, ordered},
    workspace::Workspace,
};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// About as many vertices are compared as this: more do not change the gains.
const VERTICES: usize = 16384;
/// Darker values are mostly noise, brighter ones may be saturated.
const TRUSTED: core::ops::RangeInclusive<f32> = 12.0..=248.0;
/// How gains are solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GainParams {
    /// Views compare a vertex only if both see it at least this well: cosine between ray and normal, times the pixel's
    /// cleanness.
    pub min_score: f32,
    /// Pull of every gain towards one, in vertices. It decides only where cameras share next to nothing.
    pub prior: f64,
}

/// What well-placed views see of some of the vertices.
pub(super) struct Overlap {
    /// Every `stride`th vertex is compared.
    stride: usize,
    views: usize,
    /// (vertex, view, colour) in order of views.
    samples: Vec<(u32, u16, Vec3)>,
}

impl Overlap {
    pub(super) fn new(vertices: usize, views: usize, workspace: &mut Workspace) -> Self {
        Self { stride: vertices.div_ceil(VERTICES).max(1), views, samples: workspace.take() }
    }

    /// Hands its memory back.
    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.samples);
    }

    pub(super) fn add(&mut self, vertex: usize, view: usize, candidate: &Candidate, params: &GainParams) {
        if vertex.is_multiple_of(self.stride) && candidate.score >= params.min_score {
            self.samples.push((vertex as u32, view as u16, candidate.rgb));
        }
    }

    /// Gains by least squares in the log domain over pairs of views, each pair with the median ratio of what both see:
    /// highlights, shadows and points off the surface do not count. Their geometric mean is one.
    pub(super) fn solve(&mut self, params: &GainParams, workspace: &mut Workspace) -> Vec<Vec3> {
        let n = self.views;
        let mut gains = vec![Vec3::ONE; n];
        self.samples.sort_unstable_by_key(|&(vertex, view, _)| (vertex, view));
        // Pair of views, and the ratio's logarithm as an ordered integer.
        let mut ratios: Vec<u64> = workspace.take();
        for channel in 0..3 {
            ratios.clear();
            for group in self.samples.chunk_by(|a, b| a.0 == b.0) {
                for (k, &(_, i, a)) in group.iter().enumerate() {
                    for &(_, j, b) in &group[k + 1..] {
                        let (a, b) = (a[channel], b[channel]);
                        if TRUSTED.contains(&a) && TRUSTED.contains(&b) {
                            let log = ordered(libm::logf(b / a));
                            ratios.push(u64::from(i) << 48 | u64::from(j) << 32 | u64::from(log));
                        }
                    }
                }
            }
            ratios.sort_unstable();
            let mut matrix = vec![0.0f64; n * n];
            let mut right = vec![0.0f64; n];
            for pair in ratios.chunk_by(|a, b| a >> 32 == b >> 32) {
                let (i, j) = ((pair[0] >> 48) as usize, (pair[0] >> 32) as u16 as usize);
                let median = f64::from(from_ordered(pair[pair.len() / 2] as u32));
                let weight = pair.len() as f64;
                matrix[i * n + i] += weight;
                matrix[j * n + j] += weight;
                matrix[i * n + j] -= weight;
                matrix[j * n + i] -= weight;
                right[i] += weight * median;
                right[j] -= weight * median;
            }
            for i in 0..n {
                matrix[i * n + i] += params.prior;
            }
            let logs = solve_symmetric(matrix, right);
            let mean = logs.iter().sum::<f64>() / n as f64;
            for (gain, log) in gains.iter_mut().zip(logs) {
                gain[channel] = libm::exp(log - mean) as f32;
            }
        }
        workspace.recycle(ratios);
        gains
    }
}

/// Solves a symmetric positive definite system by elimination.
fn solve_symmetric(mut m: Vec<f64>, mut x: Vec<f64>) -> Vec<f64> {
    let n = x.len();
    for k in 0..n {
        for i in k + 1..n {
            let factor = m[i * n + k] / m[k * n + k];
            for j in k + 1..n {
                m[i * n + j] -= factor * m[k * n + j];
            }
            x[i] -= factor * x[k];
        }
    }
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| m[k * n + j] * x[j]).sum();
        x[k] = (x[k] - sum) / m[k * n + k];
    }
    x
}
