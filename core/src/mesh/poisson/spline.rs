//! Stencils of the quadratic B-spline, which connect points and nodes.

use glam::Vec3;

use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};
use crate::math::floor;
use crate::surface::bspline::quadratic;

/// Index of a node that is not stored.
pub(super) const ABSENT: u32 = u32::MAX;

/// Integrals of the quadratic B-spline over the four edges nearest to a point that lies `d` beyond the node in their
/// middle. They are the values of the cubic B-spline.
#[inline]
pub(super) fn along_edges(d: f32) -> [f32; 4] {
    let (below, above) = (0.5 - d, 0.5 + d);
    let near = |t: f32| (4.0 + t * t * (3.0 * t - 6.0)) / 6.0;
    [below * below * below / 6.0, near(above), near(below), above * above * above / 6.0]
}

/// The 27 nodes around a point whose splines reach it, with the values of the B-spline along each axis.
pub(super) struct Stencil {
    /// Indices of the nodes' values, x fastest.
    pub(super) nodes: [u32; 27],
    /// Values at the three nodes along each axis.
    pub(super) values: [[f32; 3]; 3],
}

impl Stencil {
    /// The stencil of a point in the grid's coordinates (nodes at integers). `place` is that of [`Cube::new`].
    pub(super) fn new(grid: &SparseGrid, point: Vec3, place: impl FnMut(u32) -> u32) -> Self {
        let nearest = point.to_array().map(|v| floor(v + 0.5));
        let values = core::array::from_fn(|k| quadratic(point[k] - nearest[k] as f32));
        Self { nodes: cube::<3, 27>(grid, nearest.map(|v| v - 1), place), values }
    }

    /// Sums a field over the stencil, weighted by the spline.
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

/// Nodes along an axis that the divergence of a point reaches, which is the largest edge of a [`Cube`].
pub(super) const WIDEST: usize = 5;

/// Locates the values of a cube of nodes.
pub(super) struct Cube {
    /// Index of the first value of each block that the nodes can lie in, or [`ABSENT`] if the block is not stored.
    blocks: [u32; 8],
    /// For each node along each axis: its contribution to the index into `blocks`, and its offset within the block.
    places: [[(usize, u32); WIDEST]; 3],
}

impl Cube {
    /// The cube of `side` nodes along each axis that starts at node `first`. Indices are those of the grid if `place` returns
    /// the slot that it gets, and otherwise those of an array in which each block has the place that it returns.
    pub(super) fn new(grid: &SparseGrid, first: [i32; 3], side: usize, mut place: impl FnMut(u32) -> u32) -> Self {
        let shift = BLOCK.trailing_zeros();
        let mask = BLOCK as i32 - 1;
        let low = first.map(|v| v >> shift);
        let high = first.map(|v| (v + side as i32 - 1) >> shift);
        let mut blocks = [ABSENT; 8];
        for (i, block) in blocks.iter_mut().enumerate() {
            let at = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
            if (0..3).all(|k| i >> k & 1 == 0 || high[k] != low[k]) {
                let slot = grid.slot(at(0), at(1), at(2));
                if slot < SparseGrid::INSIDE {
                    *block = place(slot) * BLOCK_NODES as u32;
                }
            }
        }
        let mut places = [[(0, 0); WIDEST]; 3];
        for (k, places) in places.iter_mut().enumerate() {
            for (v, place) in (first[k]..).zip(&mut places[..side]) {
                *place = (usize::from(v >> shift != low[k]) << k, ((v & mask) as u32) << (k as u32 * shift));
            }
        }
        Self { blocks, places }
    }

    /// Indices of the values of a row along x, or [`ABSENT`] where they are not stored.
    #[inline]
    pub(super) fn row(&self, y: usize, z: usize) -> [u32; WIDEST] {
        let (y, z) = (self.places[1][y], self.places[2][z]);
        let blocks = [self.blocks[y.0 | z.0], self.blocks[1 | y.0 | z.0]];
        self.places[0].map(|(upper, x)| {
            let block = blocks[upper];
            if block == ABSENT { ABSENT } else { block + (x | y.1 | z.1) }
        })
    }
}

/// Indices of the values of the N³ nodes of the cube that starts at node `first`, x fastest. `place` is that of
/// [`Cube::new`].
pub(super) fn cube<const N: usize, const NODES: usize>(
    grid: &SparseGrid,
    first: [i32; 3],
    place: impl FnMut(u32) -> u32,
) -> [u32; NODES] {
    let cube = Cube::new(grid, first, N, place);
    let mut nodes = [ABSENT; NODES];
    for (i, row) in nodes.chunks_exact_mut(N).enumerate() {
        row.copy_from_slice(&cube.row(i % N, i / N)[..N]);
    }
    nodes
}
