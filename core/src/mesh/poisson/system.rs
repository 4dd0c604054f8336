//! The linear system of one level, in units of the level's voxel: (-Δ + screening) χ = -div V + screening · target,
//! with V the smoothed field of inward normals, where the screening acts at the points (Kazhdan & Hoppe 2013).

use alloc::vec::Vec;
use glam::Vec3;

use super::profile;
use super::samples::Sample;
use super::spline::{ABSENT, Cube, WIDEST, along_edges, cube};
use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};
use crate::math::{floor, min};
use crate::surface::bspline::quadratic;
use crate::workspace::Workspace;

/// The merged points of one cell of the grid. The screening term pulls the surface to their mean position.
pub(super) struct Cell {
    /// Indices of the values at the cell's corners, x fastest.
    pub(super) nodes: [u32; 8],
    /// Trilinear weights of the corners.
    pub(super) shares: [f32; 8],
    /// Area of surface in square voxels.
    pub(super) area: f32,
    /// Mean standard deviation of the points.
    pub(super) sigma: f32,
    /// Target of the interpolated χ at the mean position: its value if the surface passes there with the mean normal.
    /// It differs slightly from 1/2 because χ is curved between the corners.
    pub(super) chi: f32,
}

impl Cell {
    /// χ at the mean position, interpolated from the corners.
    #[inline]
    pub(super) fn value(&self, chi: &[f32]) -> f32 {
        let mut sum = 0.0;
        for (&node, share) in self.nodes.iter().zip(self.shares) {
            sum += share * chi[node as usize];
        }
        sum
    }
}

/// Adds the right-hand side of the samples: -div V with V = -n a B(x - p), where n is the normal, a the area, p the
/// position and B the quadratic B-spline. `shares` maps a sample's level of detail to its share in each of the one or
/// two fields.
///
/// The divergence at a node is computed as the difference of the integrals of V over the edges that meet there.
/// Differences of χ along edges are then equal to those integrals. Therefore χ at the nodes is exactly the smoothed
/// indicator function, for any orientation of the surface.
pub(super) fn splat(
    samples: &[Sample],
    grid: &SparseGrid,
    level: usize,
    shares: impl Fn(f32) -> [f32; 2],
    fields: &mut [&mut [f32]],
) {
    let scale = 1.0 / (1 << level) as f32;
    for sample in samples {
        let shares = shares(sample.detail);
        if shares == [0.0; 2] {
            continue;
        }
        let at = (sample.at * scale).to_array();
        let nearest = at.map(|v| floor(v + 0.5));
        let cube = Cube::new(grid, nearest.map(|v| v - 2), WIDEST);
        let (mut values, mut differences) = ([[0.0; WIDEST]; 3], [[0.0; WIDEST]; 3]);
        for k in 0..3 {
            let d = at[k] - nearest[k] as f32;
            values[k][1..4].copy_from_slice(&quadratic(d));
            let [a, b, c, d] = along_edges(d);
            differences[k] = [a, b - a, c - b, d - c, -d];
        }
        let ([vx, vy, vz], [dx, dy, dz]) = (values, differences);
        let n = sample.normal * (sample.area * scale * scale);
        let inner = |v: usize| (1..4).contains(&v);
        for (z, y) in (0..WIDEST).flat_map(|z| (0..WIDEST).map(move |y| (z, y))) {
            let reached = match (inner(y), inner(z)) {
                (true, true) => 0..WIDEST,
                (false, false) => continue,
                _ => 1..4,
            };
            let (along, across) = (n.x * vy[y] * vz[z], n.y * dy[y] * vz[z] + n.z * vy[y] * dz[z]);
            let row: [f32; WIDEST] = core::array::from_fn(|x| along * dx[x] + across * vx[x]);
            let nodes = cube.row(y, z);
            for x in reached {
                if nodes[x] != ABSENT {
                    for (field, share) in fields.iter_mut().zip(shares) {
                        field[nodes[x] as usize] += share * row[x];
                    }
                }
            }
        }
    }
}

/// Merges the samples in the cells of the grid.
pub(super) fn cells(samples: &[Sample], grid: &SparseGrid, level: usize, workspace: &mut Workspace) -> Vec<Cell> {
    const NONE: u32 = u32::MAX;
    let scale = 1.0 / (1 << level) as f32;
    let mut index = workspace.filled(NONE, grid.blocks.len() * BLOCK_NODES);
    // Sums of area, area times the offset from the cell's first corner, area times normal, and area times standard
    // deviation; then that corner.
    let mut sums: Vec<([f32; 8], [i32; 3])> = workspace.take();
    for sample in samples {
        let at = sample.at * scale;
        let corner = [at.x, at.y, at.z].map(floor);
        let (slot, local) = grid.locate(corner[0], corner[1], corner[2]);
        if slot >= SparseGrid::INSIDE {
            continue;
        }
        let entry = &mut index[slot as usize * BLOCK_NODES + local];
        if *entry == NONE {
            *entry = sums.len() as u32;
            sums.push(([0.0; 8], corner));
        }
        let area = sample.area * scale * scale;
        let sum = &mut sums[*entry as usize].0;
        sum[0] += area;
        sum[7] += area * sample.sigma;
        for k in 0..3 {
            sum[1 + k] += area * (at[k] - corner[k] as f32);
            sum[4 + k] += area * sample.normal[k];
        }
    }
    workspace.recycle(index);
    let mut cells = workspace.empty(sums.len());
    for &([area, x, y, z, nx, ny, nz, sigma], corner) in &sums {
        let nodes: [u32; 8] = cube::<2, 8>(grid, corner);
        if area <= 0.0 || nodes.contains(&ABSENT) {
            continue;
        }
        let offset = [x, y, z].map(|v| v / area);
        let share = |i: usize, k: usize| if i >> k & 1 == 1 { offset[k] } else { 1.0 - offset[k] };
        let shares: [f32; 8] = core::array::from_fn(|i| share(i, 0) * share(i, 1) * share(i, 2));
        let normal = Vec3::new(nx, ny, nz).normalize_or_zero();
        let chi = (0..8).fold(0.5, |sum, i| {
            let outward = Vec3::from_array(core::array::from_fn(|k| (i >> k & 1) as f32 - offset[k])).dot(normal);
            sum + shares[i] * profile::chi(-outward)
        });
        // A sample of a coarser level represents more surface than this cell contains.
        cells.push(Cell { nodes, shares, area: min(area, 1.0), sigma: sigma / area, chi });
    }
    workspace.recycle(sums);
    cells
}

/// Reciprocal of the system's diagonal. It is 0 where χ is given: at nodes that are `fixed`, and at the border of the
/// stored blocks.
pub(super) fn inverse_diagonal(
    neighbours: &[[u32; 6]],
    cells: &[Cell],
    screening: f32,
    fixed: impl Fn(usize) -> bool,
    workspace: &mut Workspace,
) -> Vec<f32> {
    let mut diagonal = workspace.filled(6.0_f32, neighbours.len() * BLOCK_NODES);
    for cell in cells {
        for (&node, share) in cell.nodes.iter().zip(cell.shares) {
            diagonal[node as usize] += screening * cell.area * share * share;
        }
    }
    for (slot, around) in neighbours.iter().enumerate() {
        for local in 0..BLOCK_NODES {
            let at = [local % BLOCK, local / BLOCK % BLOCK, local / BLOCK / BLOCK];
            let border = (0..3).any(|k| {
                (at[k] == 0 && around[2 * k] == ABSENT) || (at[k] == BLOCK - 1 && around[2 * k + 1] == ABSENT)
            });
            let node = slot * BLOCK_NODES + local;
            diagonal[node] = if border || fixed(node) { 0.0 } else { 1.0 / diagonal[node] };
        }
    }
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
    use crate::mesh::poisson::samples;
    use crate::point_cloud::{Point, Rank};

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
            let samples = samples::collect(&[point], &grid, workspace, || Ok(())).expect("nothing cancels");
            let mut rhs = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
            splat(&samples, &grid, 0, |_| [1.0, 0.0], &mut [&mut rhs]);
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
