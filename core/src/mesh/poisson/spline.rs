//! The quadratic B-spline by which points and nodes see each other.

use glam::Vec3;

use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};
use crate::math::floor;

/// Index of a node that is not stored.
pub(super) const ABSENT: u32 = u32::MAX;

/// Values at the three nodes nearest to a point that lies `d` beyond the middle one.
#[inline]
pub(super) fn quadratic(d: f32) -> [f32; 3] {
    let (below, above) = (0.5 - d, 0.5 + d);
    [0.5 * below * below, 0.75 - d * d, 0.5 * above * above]
}

/// Integrals over the four edges that are nearest to a point that lies `d` beyond the node in their middle: a cubic
/// B-spline's values.
#[inline]
pub(super) fn along_edges(d: f32) -> [f32; 4] {
    let (below, above) = (0.5 - d, 0.5 + d);
    let near = |t: f32| (4.0 + t * t * (3.0 * t - 6.0)) / 6.0;
    [below * below * below / 6.0, near(above), near(below), above * above * above / 6.0]
}

/// The 27 nodes that see a point, with the B-spline's values along each axis.
pub(super) struct Stencil {
    /// Indices of the nodes' values, x fastest.
    pub(super) nodes: [u32; 27],
    /// Values for the three nodes of an axis.
    pub(super) values: [[f32; 3]; 3],
}

impl Stencil {
    /// Of a point given in the grid's own coordinates (nodes at integers).
    pub(super) fn new(grid: &SparseGrid, point: Vec3) -> Self {
        let nearest = point.to_array().map(|v| floor(v + 0.5));
        let values = core::array::from_fn(|k| quadratic(point[k] - nearest[k] as f32));
        Self { nodes: cube::<3, 27>(grid, nearest.map(|v| v - 1)), values }
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

/// Nodes along an axis that a point's divergence reaches: most along the edge of a [`Cube`].
pub(super) const WIDEST: usize = 5;

/// Where the values of a cube of nodes are.
pub(super) struct Cube {
    /// First value of each of the blocks that the nodes can lie in, [`ABSENT`] where none is stored.
    blocks: [u32; 8],
    /// Along each axis: which of the blocks, and where in it.
    places: [[(usize, u32); WIDEST]; 3],
}

impl Cube {
    /// `side` nodes along each axis from `first` upward.
    pub(super) fn new(grid: &SparseGrid, first: [i32; 3], side: usize) -> Self {
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
                    *block = slot * BLOCK_NODES as u32;
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

    /// Indices of the values of a row along x, [`ABSENT`] where they are not stored.
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

/// Indices of the values of the N³ nodes from `first` upward, x fastest.
pub(super) fn cube<const N: usize, const NODES: usize>(grid: &SparseGrid, first: [i32; 3]) -> [u32; NODES] {
    let cube = Cube::new(grid, first, N);
    let mut nodes = [ABSENT; NODES];
    for (i, row) in nodes.chunks_exact_mut(N).enumerate() {
        row.copy_from_slice(&cube.row(i % N, i / N)[..N]);
    }
    nodes
}
