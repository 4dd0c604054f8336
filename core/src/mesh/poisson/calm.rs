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

/// For each node the variance of the points around it, in their own unit. Infinite where there are no points.
pub(super) fn variances(cells: &Cells, nodes: usize, workspace: &mut Workspace, executor: &dyn Executor) -> Vec<f32> {
    let mut sums = workspace.filled([0.0_f32; 2], nodes);
    cells.scatter(&mut sums, executor, |sum, cell, share| {
        let weight = cell.area * share;
        sum[0] += weight * cell.sigma;
        sum[1] += weight;
    });
    let mut variances = workspace.empty(nodes);
    variances.extend(sums.iter().map(|&[sigma, weight]| {
        if weight > 0.0 {
            let sigma = sigma / weight;
            sigma * sigma
        } else {
            f32::INFINITY
        }
    }));
    workspace.recycle(sums);
    variances
}

/// Takes the finest detail out of the signed distances at a grid's nodes, in voxels. `half` is the standard deviation at
/// which half of it goes.
pub(super) fn calm(
    grid: &SparseGrid,
    distances: &mut [f32],
    variances: &[f32],
    half: f32,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) {
    for distance in &mut *distances {
        *distance = distance.clamp(-FAR, FAR);
    }
    let smoothed = smooth::smooth(grid, distances, [FAR, -FAR], workspace, executor);
    for ((distance, smoothed), &variance) in distances.iter_mut().zip(&smoothed).zip(variances) {
        // 1 for an infinite variance. Written so that zero by zero is not divided.
        let kept = if half > 0.0 { half * half / (variance + half * half) } else { 0.0 };
        *distance = *smoothed + kept * (*distance - *smoothed);
    }
    workspace.recycle(smoothed);
}
