//! The linear system of one level, in units of the level's voxel: (-Δ + screening) χ = -div V + screening · target,
//! with V the smoothed field of inward normals, where the screening acts at the points (Kazhdan & Hoppe 2013).

use alloc::vec::Vec;

use super::cells::Cells;
use super::patch::{self, Patch};
use super::samples::Sample;
use super::spline::{ABSENT, Cube, WIDEST, along_edges};
use crate::error::Result;
use crate::executor::Executor;
use crate::grid::{BLOCK, BLOCK_NODES, BLOCKS_PER_JOB, SparseGrid};
use crate::math::floor;
use crate::surface::bspline::quadratic;
use crate::workspace::Workspace;

/// Adds the right-hand side of the samples: -div V with V = -n a B(x - p), where n is the normal, a the area, p the
/// position and B the quadratic B-spline. `shares` maps a sample's level of detail to its share in each of the fields.
/// `step` is called before each part of the samples.
///
/// The divergence at a node is computed as the difference of the integrals of V over the edges that meet there.
/// Differences of χ along edges are then equal to those integrals. Therefore χ at the nodes is exactly the smoothed
/// indicator function, for any orientation of the surface.
pub(super) fn splat<const N: usize>(
    samples: &[Sample],
    grid: &SparseGrid,
    level: usize,
    shares: impl Fn(f32) -> [f32; N] + Sync,
    mut fields: [&mut [f32]; N],
    executor: &dyn Executor,
    step: impl FnMut() -> Result<()>,
) -> Result<()> {
    let scale = 1.0 / (1 << level) as f32;
    let contribute = |sample: &Sample, patch: &mut Patch<N>| {
        let shares = shares(sample.detail);
        if shares == [0.0; N] {
            return;
        }
        let at = (sample.at * scale).to_array();
        let nearest = at.map(|v| floor(v + 0.5));
        let cube = Cube::new(grid, nearest.map(|v| v - 2), WIDEST, |slot| patch.place(slot));
        let (mut values, mut differences) = ([[0.0; WIDEST]; 3], [[0.0; WIDEST]; 3]);
        for k in 0..3 {
            let d = at[k] - nearest[k] as f32;
            values[k][1..4].copy_from_slice(&quadratic(d));
            let [a, b, c, d] = along_edges(d);
            differences[k] = [a, b - a, c - b, d - c, -d];
        }
        let ([vx, vy, vz], [dx, dy, dz]) = (values, differences);
        let n = sample.normal * (sample.area * scale * scale);
        let outer = |v: usize| v == 0 || v == WIDEST - 1;
        for (z, y) in (0..WIDEST).flat_map(|z| (0..WIDEST).map(move |y| (z, y))) {
            if outer(y) && outer(z) {
                continue;
            }
            // Where y or z is outer, the ends of the row are zero.
            let (along, across) = (n.x * vy[y] * vz[z], n.y * dy[y] * vz[z] + n.z * vy[y] * dz[z]);
            let row: [f32; WIDEST] = core::array::from_fn(|x| along * dx[x] + across * vx[x]);
            cube.row(y, z).add(patch.sums(), &row.map(|value| shares.map(|share| share * value)));
        }
    };
    let add = |first: usize, sums: &[[f32; N]]| {
        for (k, field) in fields.iter_mut().enumerate() {
            for (value, sum) in field[first..].iter_mut().zip(sums) {
                *value += sum[k];
            }
        }
    };
    patch::accumulate(samples, grid, contribute, add, executor, step)
}

/// Reciprocal of the system's diagonal. It is 0 where χ is given: at nodes that are `fixed`, and at the border of the
/// stored blocks.
pub(super) fn inverse_diagonal(
    neighbours: &[[u32; 6]],
    cells: &Cells,
    screening: f32,
    fixed: impl Fn(usize) -> bool + Sync,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Vec<f32> {
    let mut diagonal = workspace.filled(6.0_f32, neighbours.len() * BLOCK_NODES);
    cells.scatter(&mut diagonal, executor, |value, cell, share| {
        *value += screening * cell.area * share * share;
    });
    executor.map_parts(diagonal.chunks_mut(BLOCKS_PER_JOB * BLOCK_NODES), |i, part| {
        for (slot, block) in (i * BLOCKS_PER_JOB..).zip(part.chunks_exact_mut(BLOCK_NODES)) {
            let around = &neighbours[slot];
            for (local, value) in block.iter_mut().enumerate() {
                let at = [local % BLOCK, local / BLOCK % BLOCK, local / BLOCK / BLOCK];
                let border = (0..3).any(|k| {
                    (at[k] == 0 && around[2 * k] == ABSENT) || (at[k] == BLOCK - 1 && around[2 * k + 1] == ABSENT)
                });
                *value = if border || fixed(slot * BLOCK_NODES + local) { 0.0 } else { 1.0 / *value };
            }
        }
    });
    diagonal
}

/// Slots of the blocks below and above each block along x, y, z.
pub(super) fn neighbours(grid: &SparseGrid) -> Vec<[u32; 6]> {
    let slot = |x: i32, y: i32, z: i32| {
        let slot = grid.slot(x, y, z);
        if slot < SparseGrid::INSIDE { slot } else { ABSENT }
    };
    let around = |b: &[u16; 3]| {
        let [x, y, z] = b.map(i32::from);
        [
            slot(x - 1, y, z),
            slot(x + 1, y, z),
            slot(x, y - 1, z),
            slot(x, y + 1, z),
            slot(x, y, z - 1),
            slot(x, y, z + 1),
        ]
    };
    grid.blocks.iter().map(around).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Serial;
    use crate::mesh::poisson::{profile, samples};
    use crate::point_cloud::{Point, Rank};
    use glam::Vec3;

    /// For a plane of points, χ at the nodes is its profile, and the right-hand side is minus the second difference of
    /// the profile. Summing the contributions of one point over a plane of nodes is equivalent to a plane of points.
    #[test]
    fn differences_of_chi_are_integrals_along_edges() {
        let grid = SparseGrid::new(Vec3::ZERO, 1.0, [2; 3], |_| 0);
        for (axis, at) in [(0, 6.3), (1, 7.0), (2, 7.5), (0, 8.49), (1, 8.9)] {
            let mut position = Vec3::new(7.8, 8.1, 6.6);
            position[axis] = at;
            let normal = Vec3::from_array(core::array::from_fn(|k| f32::from(u8::from(k == axis))));
            let point =
                Point { position, normal, fidelity: 1.0, sigma: 0.0, weight: 1.0, view: 0, rank: Rank::Detected };
            let workspace = &mut Workspace::default();
            let samples =
                samples::collect((&[point]).into(), &grid, workspace, &Serial, || Ok(())).expect("nothing cancels");
            let mut rhs = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
            splat(&samples, &grid, 0, |_| [1.0], [&mut rhs[..]], &Serial, || Ok(())).expect("nothing cancels");
            for layer in 1..15 {
                let mut sum = 0.0;
                for (u, v) in (0..16).flat_map(|u| (0..16).map(move |v| (u, v))) {
                    let mut node = [layer; 3];
                    node[(axis + 1) % 3] = u;
                    node[(axis + 2) % 3] = v;
                    sum += grid.value(&rhs, node[0], node[1], node[2], 0.0, 0.0);
                }
                let chi = |layer: i32| profile::chi(at - layer as f32);
                let expected = 2.0 * chi(layer) - chi(layer - 1) - chi(layer + 1);
                assert!((sum - expected).abs() < 1e-5, "axis {axis}, {at}, layer {layer}: {sum}, not {expected}");
            }
        }
    }
}
