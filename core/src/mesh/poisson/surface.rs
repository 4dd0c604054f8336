//! From the solution to the mesh.

use alloc::vec::Vec;
use glam::Vec3;

use super::level::GridLevel;
use super::profile::{SMOOTHED, SOLVED};
use super::smooth;
use super::solution::{MARGIN, Solution};
use crate::math::{max, min};
use crate::point_cloud::Mesh;
use crate::surface::{Unstored, marching_cubes};
use crate::workspace::Workspace;

/// How far outside the envelope the surface may lie, in voxels.
const TOLERANCE: f32 = 0.1;

/// Distance to the surface χ = `iso` at the nodes, in voxels, positive inside; `envelope` is that to the envelope.
///
/// χ is smoothed but where a value that the envelope holds is in the smoothing's reach: near the silhouettes' contours,
/// which say where the surface ends, it would be rounded off.
pub(super) fn distances(
    level: &GridLevel,
    iso: f32,
    envelope: Option<&Vec<f32>>,
    workspace: &mut Workspace,
) -> Vec<f32> {
    let mut distances = smooth::smooth(&level.grid, &level.chi, [1.0, 0.0], workspace);
    for (node, (distance, &chi)) in distances.iter_mut().zip(&level.chi).enumerate() {
        let share = envelope.map_or(1.0, |envelope| min(max(envelope[node] + (MARGIN - smooth::REACH), 0.0), 1.0));
        let (smoothed, solved) = (SMOOTHED.distance(*distance - iso), SOLVED.distance(chi - iso));
        *distance = share * smoothed + (1.0 - share) * solved;
    }
    distances
}

impl Solution {
    /// The surface, cut off at the envelope.
    pub(in crate::mesh) fn surface(self, workspace: &mut Workspace) -> Mesh {
        let Self { grid, mut distances, envelope } = self;
        if let Some(envelope) = &envelope {
            for (distance, envelope) in distances.iter_mut().zip(envelope) {
                *distance = min(envelope + TOLERANCE, *distance);
            }
        }
        let mesh = marching_cubes(&grid, &distances, 0.0, Unstored { inside: 1.0, outside: -1.0 }, workspace);
        workspace.recycle(distances);
        envelope.into_iter().for_each(|envelope| workspace.recycle(envelope));
        mesh
    }
}

/// Each normal becomes the mean over the triangles around it: the sampling's chance, which tilts the gradient of χ from
/// node to node, halves.
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
