//! Stencils of the quadratic B-spline, which connect points and nodes.

use core::ops::Range;
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
    cube: Cube,
    /// Values at the three nodes along each axis.
    values: [[f32; 3]; 3],
}

impl Stencil {
    /// The stencil of a point in the grid's coordinates (nodes at integers). `place` is that of [`Cube::new`].
    #[inline]
    pub(super) fn new(grid: &SparseGrid, point: Vec3, place: impl FnMut(u32) -> u32) -> Self {
        let nearest = point.to_array().map(|v| floor(v + 0.5));
        let values = core::array::from_fn(|k| quadratic(point[k] - nearest[k] as f32));
        Self { cube: Cube::new(grid, nearest.map(|v| v - 1), 3, place), values }
    }

    /// The rows of nodes along x, with the spline's values at their nodes.
    #[inline]
    pub(super) fn rows(&self) -> impl Iterator<Item = (Row, [f32; 3])> {
        let [vx, vy, vz] = self.values;
        let row = move |y: usize, z: usize| (self.cube.row(y, z), vx.map(|v| v * vy[y] * vz[z]));
        (0..3).flat_map(move |z| (0..3).map(move |y| row(y, z)))
    }

    /// Sums a field over the stencil, weighted by the spline.
    #[inline]
    pub(super) fn gather<const N: usize>(&self, field: &[[f32; N]]) -> [f32; N] {
        let mut sum = [0.0; N];
        for (row, weights) in self.rows() {
            for (first, nodes) in row.parts() {
                for (values, &weight) in field[nodes].iter().zip(&weights[first..]) {
                    (0..N).for_each(|k| sum[k] += weight * values[k]);
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
    /// Nodes along an axis.
    side: usize,
    /// Index of the first value of each block that the nodes can lie in, or [`ABSENT`] if the block is not stored.
    blocks: [u32; 8],
    /// Offset of the first node along x within its block, and the number of nodes in that block.
    start: u32,
    split: usize,
    /// For each node along y and z: its contribution to the index into `blocks`, and its offset within the block.
    places: [[(usize, u32); WIDEST]; 2],
}

impl Cube {
    /// The cube of `side` nodes along each axis that starts at node `first`. Indices are those of the grid if `place` returns
    /// the slot that it gets, and otherwise those of an array in which each block has the place that it returns.
    #[inline]
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
        let mut places = [[(0, 0); WIDEST]; 2];
        for (k, places) in (1..).zip(&mut places) {
            for (v, place) in (first[k]..).zip(&mut places[..side]) {
                *place = (usize::from(v >> shift != low[k]) << k, ((v & mask) as u32) << (k as u32 * shift));
            }
        }
        let start = (first[0] & mask) as u32;
        Self { side, blocks, start, split: side.min(BLOCK - start as usize), places }
    }

    /// The row of nodes along x.
    #[inline]
    pub(super) fn row(&self, y: usize, z: usize) -> Row {
        let (y, z) = (self.places[0][y], self.places[1][z]);
        let blocks = [self.blocks[y.0 | z.0], self.blocks[1 | y.0 | z.0]];
        let first = |block: u32, x: u32| if block == ABSENT { ABSENT } else { block + (x | y.1 | z.1) };
        Row { low: first(blocks[0], self.start), high: first(blocks[1], 0), split: self.split, side: self.side }
    }
}

/// A row of nodes along x, which lie in one block or in two.
#[derive(Clone, Copy)]
pub(super) struct Row {
    /// Index of the first node's value in each of the blocks, or [`ABSENT`] if the block is not stored.
    low: u32,
    high: u32,
    /// Number of nodes in the lower block, and in both.
    split: usize,
    side: usize,
}

impl Row {
    /// The nodes in each block: the place of the first one in the row, and the indices of their values. There are none if the
    /// block is not stored.
    #[inline]
    fn parts(self) -> [(usize, Range<usize>); 2] {
        let part = |first: u32, count: usize| {
            if first == ABSENT { 0..0 } else { first as usize..first as usize + count }
        };
        [(0, part(self.low, self.split)), (self.split, part(self.high, self.side - self.split))]
    }

    /// Adds values to the row's nodes.
    #[inline]
    pub(super) fn add<const N: usize, const SIDE: usize>(self, field: &mut [[f32; N]], values: &[[f32; N]; SIDE]) {
        let add = |sums: &mut [f32; N], values: &[f32; N]| (0..N).for_each(|k| sums[k] += values[k]);
        for (first, nodes) in self.parts() {
            let field = &mut field[nodes];
            // Mostly the whole row is in one block. The length is then known, so that vectors are added.
            if let Ok(field) = <&mut [[f32; N]; SIDE]>::try_from(&mut *field) {
                (0..SIDE).for_each(|x| add(&mut field[x], &values[x]));
            } else {
                add_to_some(field.as_flattened_mut(), values[first..].as_flattened());
            }
        }
    }
}

/// Adds values to as many sums. It is compiled once, for rows of any kind.
#[inline(never)]
fn add_to_some(sums: &mut [f32], values: &[f32]) {
    sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
}

/// Indices of the values of the N³ nodes of the cube that starts at node `first`, x fastest, or [`ABSENT`] where they are not
/// stored. `place` is that of [`Cube::new`].
pub(super) fn cube<const N: usize, const NODES: usize>(
    grid: &SparseGrid,
    first: [i32; 3],
    place: impl FnMut(u32) -> u32,
) -> [u32; NODES] {
    let cube = Cube::new(grid, first, N, place);
    let mut nodes = [ABSENT; NODES];
    for (i, row) in nodes.chunks_exact_mut(N).enumerate() {
        for (first, indices) in cube.row(i % N, i / N).parts() {
            row[first..].iter_mut().zip(indices).for_each(|(node, index)| *node = index as u32);
        }
    }
    nodes
}
