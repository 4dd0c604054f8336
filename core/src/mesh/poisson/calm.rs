//! Calms the surface where the points are imprecise.
//!
//! The filter of [`super::smooth`] takes the finest detail out of the distances, where the noise of points and contours
//! and the creases of the hull are. A share of it goes that follows from the standard deviation σ of the points around:
//! σ² / (σ² + h²), with h the standard deviation at which half of it goes. Precise points keep their detail.

use alloc::vec::Vec;

use super::cells::Cells;
use super::smooth;
use crate::executor::Executor;
use crate::grid::SparseGrid;
use crate::workspace::Workspace;

/// Distances beyond this many voxels are cut off, because the filter would carry their steps to the surface. They only
/// say on which side of the surface a node lies.
const FAR: f32 = 2.5;

/// For each node the share of the finest detail that goes: 1 where there are no points.
pub(super) fn shares(
    cells: &Cells,
    nodes: usize,
    half: f32,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Vec<f32> {
    let mut sums = workspace.filled([0.0_f32; 2], nodes);
    cells.scatter(&mut sums, executor, |sum, cell, share| {
        let weight = cell.area * share;
        sum[0] += weight * cell.sigma;
        sum[1] += weight;
    });
    let mut shares = workspace.empty(nodes);
    shares.extend(sums.iter().map(|&[sigma, weight]| {
        // Multiplied out, so that there is no division of zero by zero.
        let (variance, kept) = (sigma * sigma, half * half * (weight * weight));
        if variance + kept > 0.0 { variance / (variance + kept) } else { 1.0 }
    }));
    workspace.recycle(sums);
    shares
}

/// Takes the shares of the finest detail out of the signed distances at a grid's nodes, in voxels.
pub(super) fn calm(
    grid: &SparseGrid,
    distances: &mut [f32],
    shares: &[f32],
    workspace: &mut Workspace,
    executor: &dyn Executor,
) {
    for distance in &mut *distances {
        *distance = distance.clamp(-FAR, FAR);
    }
    let smoothed = smooth::smooth(grid, distances, [FAR, -FAR], workspace, executor);
    for ((distance, smoothed), share) in distances.iter_mut().zip(&smoothed).zip(shares) {
        *distance += share * (smoothed - *distance);
    }
    workspace.recycle(smoothed);
}
