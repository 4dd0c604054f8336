//! Solves one gain per camera and channel, such that cameras that see the same surface agree on its colour. Not in the
//! paper.

use super::candidate::Candidate;
use crate::{
    executor::Executor,
    linear::solve_symmetric,
    math::{from_ordered, ordered, select},
    sort,
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

/// Vertex, view and colour.
pub(super) type Sample = (u32, u16, Vec3);

/// The colours of a subset of the vertices in all views that see them well.
pub(super) struct Overlap {
    /// Every `stride`th vertex is compared.
    stride: usize,
    views: usize,
    samples: Vec<Sample>,
}

impl Overlap {
    pub(super) fn new(vertices: usize, views: usize, workspace: &mut Workspace) -> Self {
        Self { stride: vertices.div_ceil(VERTICES).max(1), views, samples: workspace.take() }
    }

    /// Returns its memory to the workspace.
    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.samples);
    }

    /// Whether a view's candidate for a vertex is compared.
    pub(super) fn compares(&self, vertex: usize, candidate: &Candidate, params: &GainParams) -> bool {
        vertex.is_multiple_of(self.stride) && candidate.score >= params.min_score
    }

    /// Adds what [`Self::compares`] accepts, in any order.
    pub(super) fn add(&mut self, samples: &[Sample]) {
        self.samples.extend_from_slice(samples);
    }

    /// Solves the gains by least squares over pairs of views in the log domain. Each pair contributes the median ratio
    /// of the colours that both see, so that highlights, shadows and wrong points have no influence. The geometric mean
    /// of the gains is one.
    pub(super) fn solve(&mut self, params: &GainParams, executor: &dyn Executor) -> Vec<Vec3> {
        let n = self.views;
        let mut gains = vec![Vec3::ONE; n];
        let key = |(i, &(vertex, view, _)): (usize, &Sample)| (u64::from(vertex) << 16 | u64::from(view), i as u32);
        let mut order: Vec<(u64, u32)> = self.samples.iter().enumerate().map(key).collect();
        sort::indexed(&mut order);
        self.samples = order.into_iter().map(|(_, i)| self.samples[i as usize]).collect();
        let solved = executor.map(3, |channel| {
            let mut matrix = vec![0.0f64; n * n];
            let mut right = vec![0.0f64; n];
            for Ratio { pair: [i, j], median, weight } in self.ratios(channel) {
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
            right
        });
        for (channel, logs) in solved.into_iter().enumerate() {
            let mean = logs.iter().sum::<f64>() / n as f64;
            for (gain, log) in gains.iter_mut().zip(logs) {
                gain[channel] = libm::exp(log - mean) as f32;
            }
        }
        gains
    }

    /// The ratios of all pairs of views that have seen a vertex in common, in ascending order.
    fn ratios(&self, channel: usize) -> Vec<Ratio> {
        let n = self.views;
        let each = |found: &mut dyn FnMut(usize, f32)| {
            for group in self.samples.chunk_by(|a, b| a.0 == b.0) {
                for (k, &(_, i, a)) in group.iter().enumerate() {
                    for &(_, j, b) in &group[k + 1..] {
                        let (a, b) = (a[channel], b[channel]);
                        if TRUSTED.contains(&a) && TRUSTED.contains(&b) {
                            found(usize::from(i) * n + usize::from(j), b / a);
                        }
                    }
                }
            }
        };
        let mut starts = vec![0; n * n + 1];
        each(&mut |pair, _| starts[pair + 1] += 1);
        for pair in 0..n * n {
            starts[pair + 1] += starts[pair];
        }
        // The logarithms as ordered integers, pair after pair.
        let mut logs = vec![0u32; starts[n * n]];
        let mut next = starts.clone();
        each(&mut |pair, ratio| {
            logs[next[pair]] = ordered(libm::logf(ratio));
            next[pair] += 1;
        });
        let of = |pair: usize| {
            let logs = &mut logs[starts[pair]..starts[pair + 1]];
            let middle = logs.len() / 2;
            (!logs.is_empty()).then(|| Ratio {
                pair: [pair / n, pair % n],
                median: f64::from(from_ordered(select(logs, middle))),
                weight: logs.len() as f64,
            })
        };
        (0..n * n).filter_map(of).collect()
    }
}

/// The median of the logarithms of the ratios of two views' colours, and the number of ratios.
struct Ratio {
    pair: [usize; 2],
    median: f64,
    weight: f64,
}
