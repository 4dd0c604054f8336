//! Takes noise out of the mesh that is too coarse for [`super::calm`], as far as the precision of the points explains it.
//!
//! W moves each vertex halfway to the mean of its neighbours (Taubin, A Signal Processing Approach to Fair Surface Design,
//! SIGGRAPH 1995). The filter 3 A - 3 A² + A³ with A = Wⁿ has hardly any effect on shapes that are larger than about eight voxels:
//! unlike A alone it does not shrink limbs. A vertex moves by the full distance d that the filter asks for only if d is
//! small against what the standard deviation σ of the points around allows: by the share h² σ² / (h² σ² + d²). So precise
//! points keep their detail, and edges and fingertips, which the filter would move far, stay where they are.

use glam::Vec3;

use crate::executor::Executor;
use crate::grid::SparseGrid;
use crate::math::max;
use crate::point_cloud::Mesh;
use crate::surface::{VertexNeighbours, complete_normals};
use crate::workspace::Workspace;

/// n: how often W is applied for A.
const PASSES: usize = 8;

/// h: where σ is one pixel of footprint, half of a distance of this many voxels is noise. Found by measurement.
const HALF: f32 = 1.0 / 3.0;

/// Vertices that one job of an executor works on.
const VERTICES_PER_JOB: usize = 1 << 12;

/// Moves the vertices of a closed mesh, and sets their normals. `variances` is σ² at the nodes of the grid.
pub(super) fn denoise(
    mesh: &mut Mesh,
    grid: &SparseGrid,
    variances: &[f32],
    workspace: &mut Workspace,
    executor: &dyn Executor,
) {
    let neighbours = VertexNeighbours::new(mesh);
    let mut filtered = workspace.filled(Vec3::ZERO, mesh.positions.len());
    let mut from = workspace.empty(mesh.positions.len());
    from.extend_from_slice(&mesh.positions);
    let mut to = workspace.filled(Vec3::ZERO, mesh.positions.len());
    for factor in [3.0, -3.0, 1.0] {
        for _ in 0..PASSES {
            halfway(&neighbours, &from, &mut to, executor);
            core::mem::swap(&mut from, &mut to);
        }
        for (sum, &position) in filtered.iter_mut().zip(&from) {
            *sum += position * factor;
        }
    }
    for (position, &filtered) in mesh.positions.iter_mut().zip(&filtered) {
        let (allowed, way) = (HALF * HALF * variance(grid, variances, *position), filtered - *position);
        let distance = way.length_squared() / (grid.voxel * grid.voxel);
        // 1 for an infinite variance, and for vertices that do not move.
        let share = if distance > 0.0 { 1.0 - distance / (allowed + distance) } else { 1.0 };
        *position += way * share;
    }
    // Those of the surface as it was are as noisy as it.
    mesh.normals.fill(Vec3::ZERO);
    complete_normals(mesh);
    for buffer in [filtered, from, to] {
        workspace.recycle(buffer);
    }
}

/// W: moves each vertex halfway to the mean of its neighbours.
fn halfway(neighbours: &VertexNeighbours, from: &[Vec3], to: &mut [Vec3], executor: &dyn Executor) {
    executor.map_parts(to.chunks_mut(VERTICES_PER_JOB), |part, to| {
        for (v, to) in (part * VERTICES_PER_JOB..).zip(to) {
            // Each neighbour is listed twice, because two triangles meet at each edge.
            let around = neighbours.of(v as u32);
            let sum = around.iter().fold(Vec3::ZERO, |sum, &other| sum + from[other as usize]);
            *to = (from[v] + sum / around.len() as f32) * 0.5;
        }
    });
}

/// The variance at a position: that of the nearest node. All points have an effect on the nodes of their own voxel.
fn variance(grid: &SparseGrid, variances: &[f32], position: Vec3) -> f32 {
    let [x, y, z] = ((position - grid.origin) / grid.voxel + 0.5).to_array().map(|v| max(v, 0.0) as i32);
    grid.value(variances, x, y, z, f32::INFINITY, f32::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Serial;
    use crate::grid::BLOCK_NODES;
    use crate::math::sqrt;
    use crate::surface::{Unstored, marching_cubes};
    use alloc::vec::Vec;
    use studio::noise::Random;

    const RADIUS: f32 = 9.0;

    /// Root mean square of the distances, in voxels, of a ball's vertices from it: with noise, and after [`denoise`] with
    /// points of so many pixels of standard deviation.
    fn errors(sigma: f32) -> [f32; 2] {
        let grid = SparseGrid::new(Vec3::ZERO, 0.5, [4; 3], |_| 0);
        let middle = Vec3::splat(7.8);
        let distances: Vec<f32> = (0..grid.blocks.len() * BLOCK_NODES)
            .map(|i| {
                let (block, local) = (grid.blocks[i / BLOCK_NODES], i % BLOCK_NODES);
                let at = [local % 8, local / 8 % 8, local / 64];
                let [x, y, z] = core::array::from_fn(|k| (usize::from(block[k]) * 8 + at[k]) as f32);
                RADIUS - (grid.node(0, 0, 0) + Vec3::new(x, y, z) * grid.voxel - middle).length() / grid.voxel
            })
            .collect();
        let unstored = Unstored { inside: 1.0, outside: -1.0 };
        let mut mesh = marching_cubes(&grid, &distances, 0.0, unstored, &mut Workspace::default(), &Serial);
        let mut random = Random::new(7, 0);
        for p in &mut mesh.positions {
            *p += (*p - middle).normalize() * (0.3 * grid.voxel * random.signed() as f32);
        }
        let error = |mesh: &Mesh| {
            let distances = mesh.positions.iter().map(|p| (*p - middle).length() / grid.voxel - RADIUS);
            sqrt(distances.map(|d| d * d).sum::<f32>() / mesh.positions.len() as f32)
        };
        let before = error(&mesh);
        let variances = alloc::vec![sigma * sigma; distances.len()];
        denoise(&mut mesh, &grid, &variances, &mut Workspace::default(), &Serial);
        [before, error(&mesh)]
    }

    #[test]
    fn noise_goes_as_far_as_the_points_are_imprecise() {
        let [noisy, exact] = errors(0.0);
        assert_eq!(noisy, exact, "exact points keep their detail");
        let [_, imprecise] = errors(0.5);
        let [_, unknown] = errors(f32::INFINITY);
        assert!(imprecise < 0.9 * noisy && unknown < 0.35 * noisy, "{noisy}: {imprecise}, {unknown}");
    }
}
