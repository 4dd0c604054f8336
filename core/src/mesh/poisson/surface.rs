//! From the solution to the mesh.

use super::Solution;
use crate::mesh::marching_cubes;
use crate::point_cloud::Mesh;

/// How much the profile of χ across a surface, that of a quadratic B-spline's integral, bends: with t + BEND t³ marching
/// cubes, which interpolates linearly, meets the surface between nodes.
const BEND: f32 = 1.3;

/// Slope of χ at the surface, per voxel.
const SLOPE: f32 = 0.75;

/// How far outside the envelope the surface may lie, in voxels.
const TOLERANCE: f32 = 0.25;

impl Solution {
    /// The surface χ = iso, cut off at the envelope.
    pub(in crate::mesh) fn surface(self) -> Mesh {
        let Self { grid, mut chi, iso, distances } = self;
        for value in &mut chi {
            let t = *value - iso;
            *value = t + BEND * t * t * t;
        }
        if let Some(distances) = &distances {
            for (value, distance) in chi.iter_mut().zip(distances) {
                *value = value.min(SLOPE * (distance + TOLERANCE));
            }
        }
        marching_cubes(&grid, &chi, 0.0, 1.0, -1.0)
    }
}
