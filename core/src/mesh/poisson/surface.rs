//! Converts χ to distances and extracts the mesh from them.

use alloc::vec::Vec;
use glam::Vec3;

use super::calm;
use super::denoise;
use super::level::GridLevel;
use super::profile::{SMOOTHED, SOLVED};
use super::smooth;
use super::solution::{MARGIN, Solution};
use crate::executor::Executor;
use crate::grid::{BLOCK_NODES, BLOCKS_PER_JOB};
use crate::math::{max, min};
use crate::point_cloud::Mesh;
use crate::surface::{Unstored, marching_cubes, without_normals};
use crate::workspace::Workspace;

/// Largest distance by which the surface may lie outside the envelope, in voxels.
const TOLERANCE: f32 = 0.1;

/// Signed distance to the surface χ = `iso` at the nodes, in voxels, positive inside. `envelope` is the signed distance
/// to the envelope.
///
/// χ is smoothed, except where the filter would reach nodes that are fixed by the envelope. There the silhouettes
/// determine the surface, and smoothing would round it off.
pub(super) fn distances(
    level: &GridLevel,
    iso: f32,
    envelope: Option<&Vec<f32>>,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Vec<f32> {
    const NODES: usize = BLOCKS_PER_JOB * BLOCK_NODES;
    let mut distances = smooth::smooth(&level.grid, &level.chi, [1.0, 0.0], workspace, executor);
    executor.map_parts(distances.chunks_mut(NODES), |part, distances| {
        for (node, distance) in (part * NODES..).zip(distances) {
            let share = envelope.map_or(1.0, |envelope| min(max(envelope[node] + (MARGIN - smooth::REACH), 0.0), 1.0));
            let (smoothed, solved) = (SMOOTHED.distance(*distance - iso), SOLVED.distance(level.chi[node] - iso));
            *distance = share * smoothed + (1.0 - share) * solved;
        }
    });
    distances
}

impl Solution {
    /// The surface, clipped at the envelope, calmed and clipped again: calming smooths the edges that the first clip
    /// leaves, where the hull has creases, and may move the surface over the envelope again. What noise is left goes from the
    /// mesh.
    pub(in crate::mesh) fn surface(self, workspace: &mut Workspace, executor: &dyn Executor) -> Mesh {
        let Self { grid, mut distances, calm, envelope } = self;
        clip(&mut distances, envelope.as_deref());
        if let Some((variances, half)) = &calm {
            calm::calm(&grid, &mut distances, variances, *half, workspace, executor);
            clip(&mut distances, envelope.as_deref());
        }
        let unstored = Unstored { inside: 1.0, outside: -1.0 };
        let mesh = match calm {
            Some((variances, _)) => {
                let mut mesh = without_normals(&grid, &distances, 0.0, unstored, workspace, executor);
                denoise::denoise(&mut mesh, &grid, &variances, workspace, executor);
                workspace.recycle(variances);
                mesh
            }
            None => marching_cubes(&grid, &distances, 0.0, unstored, workspace, executor),
        };
        workspace.recycle(distances);
        envelope.into_iter().for_each(|envelope| workspace.recycle(envelope));
        mesh
    }
}

/// Clips distances to the surface at the envelope.
fn clip(distances: &mut [f32], envelope: Option<&[f32]>) {
    for (distance, envelope) in distances.iter_mut().zip(envelope.unwrap_or_default()) {
        *distance = min(envelope + TOLERANCE, *distance);
    }
}

/// Replaces each normal by the mean over the triangles around it. This halves the noise that irregular sampling causes
/// in the gradient of χ.
pub(in crate::mesh) fn smooth_normals(mesh: &mut Mesh, workspace: &mut Workspace) {
    let mut sums = workspace.filled(Vec3::ZERO, mesh.normals.len());
    for triangle in &mesh.triangles {
        let sum = triangle.iter().fold(Vec3::ZERO, |sum, &v| sum + mesh.normals[v as usize]);
        for &v in triangle {
            sums[v as usize] += sum;
        }
    }
    for (normal, sum) in mesh.normals.iter_mut().zip(&sums) {
        let length = sum.length();
        if length > 0.0 {
            *normal = *sum / length;
        }
    }
    workspace.recycle(sums);
}
