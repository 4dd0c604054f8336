//! Solves one gain per camera and channel, such that cameras that see the same surface agree on its colour. Not in the
//! paper.

use super::candidate::Candidate;
use crate::{
    linear::solve_symmetric,
    math::{from_ordered, ordered},
    workspace::Workspace,
};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Approximate number of vertices that are compared. More vertices do not change the gains.
const VERTICES: usize = 16384;
/// Levels that are compared. Darker pixels are mostly noise, and brighter pixels may be saturated.
const TRUSTED: core::ops::RangeInclusive<f32> = 12.0..=248.0;

/// Parameters of the gains.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct GainParams {
    /// Smallest score with which both views must see a vertex to be compared there: the cosine between ray and normal,
    /// times the cleanness of the pixel.
    pub min_score: f32,
    /// Weight, in vertices, of a prior that pulls every gain towards one. It matters only if cameras see hardly any
    /// common surface.
    pub prior: f64,
}

/// The colours of a subset of the vertices in all views that see them well.
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

    /// Returns its memory to the workspace.
    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.samples);
    }

    pub(super) fn add(&mut self, vertex: usize, view: usize, candidate: &Candidate, params: &GainParams) {
        if vertex.is_multiple_of(self.stride) && candidate.score >= params.min_score {
            self.samples.push((vertex as u32, view as u16, candidate.rgb));
        }
    }

    /// Solves the gains by least squares over pairs of views in the log domain. Each pair contributes the median ratio
    /// of the colours that both see, so that highlights, shadows and wrong points have no influence. The geometric mean
    /// of the gains is one.
    pub(super) fn solve(&mut self, params: &GainParams, workspace: &mut Workspace) -> Vec<Vec3> {
        let n = self.views;
        let mut gains = vec![Vec3::ONE; n];
        self.samples.sort_unstable_by_key(|&(vertex, view, _)| (vertex, view));
        // Each entry holds a pair of views and the logarithm of the ratio as an ordered integer.
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
            solve_symmetric(&mut matrix, &mut right);
            let logs = right;
            let mean = logs.iter().sum::<f64>() / n as f64;
            for (gain, log) in gains.iter_mut().zip(logs) {
                gain[channel] = libm::exp(log - mean) as f32;
            }
        }
        workspace.recycle(ratios);
        gains
    }
}
