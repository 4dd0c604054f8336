//! The quadratic B-spline by which points and nodes see each other.

use glam::Vec3;

use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};
use crate::math::floor;

/// Index of a node that is not stored.
pub(super) const ABSENT: u32 = u32::MAX;

/// The 27 nodes that see a point, with the B-spline's values and derivatives along each axis.
pub(super) struct Stencil {
    /// Indices of the nodes' values, x fastest.
    pub(super) nodes: [u32; 27],
    /// Values for the three nodes of an axis.
    pub(super) values: [[f32; 3]; 3],
    /// Derivatives for the three nodes of an axis, by the node's coordinate.
    pub(super) derivatives: [[f32; 3]; 3],
}

impl Stencil {
    /// Of a point given in the grid's own coordinates (nodes at integers).
    pub(super) fn new(grid: &SparseGrid, point: Vec3) -> Self {
        let (mut values, mut derivatives) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        let mut first = [0; 3];
        for k in 0..3 {
            let nearest = floor(point[k] + 0.5);
            let d = point[k] - nearest as f32;
            let (below, above) = (0.5 - d, 0.5 + d);
            values[k] = [0.5 * below * below, 0.75 - d * d, 0.5 * above * above];
            derivatives[k] = [below, 2.0 * d, -above];
            first[k] = nearest - 1;
        }
        Self { nodes: cube(grid, first), values, derivatives }
    }

    /// Sums `values` of the grid over the stencil.
    pub(super) fn gather<const N: usize>(&self, field: &[[f32; N]]) -> [f32; N] {
        let mut sum = [0.0; N];
        let [vx, vy, vz] = &self.values;
        for (i, &node) in self.nodes.iter().enumerate() {
            if node != ABSENT {
                let weight = vx[i % 3] * vy[i / 3 % 3] * vz[i / 9];
                for (sum, value) in sum.iter_mut().zip(field[node as usize]) {
                    *sum += weight * value;
                }
            }
        }
        sum
    }
}

/// Indices of the values of the N x N x N nodes from `first` upward, x fastest. N is at most a block's edge.
pub(super) fn cube<const M: usize>(grid: &SparseGrid, first: [i32; 3]) -> [u32; M] {
    let side = if M == 8 { 2 } else { 3 };
    let shift = BLOCK.trailing_zeros();
    let mask = BLOCK as i32 - 1;
    let low = first.map(|v| v >> shift);
    let high = first.map(|v| (v + side - 1) >> shift);
    let mut slots = [SparseGrid::OUTSIDE; 8];
    for (i, slot) in slots.iter_mut().enumerate() {
        let at = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        *slot = if (0..3).all(|k| i >> k & 1 == 0 || high[k] != low[k]) {
            grid.slot(at(0), at(1), at(2))
        } else {
            SparseGrid::OUTSIDE
        };
    }
    let mut nodes = [ABSENT; M];
    let mut i = 0;
    for z in first[2]..first[2] + side {
        for y in first[1]..first[1] + side {
            for x in first[0]..first[0] + side {
                let upper = |v: i32, k: usize| usize::from(v >> shift != low[k]) << k;
                let slot = slots[upper(x, 0) | upper(y, 1) | upper(z, 2)];
                if slot < SparseGrid::INSIDE {
                    let local = ((z & mask) << (2 * shift)) | ((y & mask) << shift) | (x & mask);
                    nodes[i] = slot * BLOCK_NODES as u32 + local as u32;
                }
                i += 1;
            }
        }
    }
    nodes
}
