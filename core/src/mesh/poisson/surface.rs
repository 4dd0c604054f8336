//! From the solution to the mesh.

use glam::Vec3;

use super::Solution;
use crate::math::min;
use crate::mesh::marching_cubes;
use crate::point_cloud::Mesh;
use crate::workspace::Workspace;

/// How much the profile of χ across a surface, that of a quadratic B-spline's integral, bends: t + BEND t³ + BEND_5 t⁵ is
/// nearly a distance, from which marching cubes finds the surface between nodes.
const BEND: f32 = 1.3;
const BEND_5: f32 = 2.0;

/// Slope of χ at the surface, per voxel.
const SLOPE: f32 = 0.75;

/// How far outside the envelope the surface may lie, in voxels.
const TOLERANCE: f32 = 0.15;

impl Solution {
    /// The surface χ = iso, cut off at the envelope.
    pub(in crate::mesh) fn surface(self, workspace: &mut Workspace) -> Mesh {
        let Self { grid, mut chi, iso, distances } = self;
        for value in &mut chi {
            let t = *value - iso;
            let square = t * t;
            *value = t * (1.0 + square * (BEND + square * BEND_5));
        }
        if let Some(distances) = &distances {
            for (value, distance) in chi.iter_mut().zip(distances) {
                *value = min(SLOPE * (distance + TOLERANCE), *value);
            }
        }
        let mesh = marching_cubes(&grid, &chi, 0.0, [1.0, -1.0], workspace);
        workspace.keep(chi);
        distances.into_iter().for_each(|distances| workspace.keep(distances));
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
    workspace.keep(sums);
}
