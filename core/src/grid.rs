//! A sparse uniform grid, stored in blocks. The hull, the Poisson solver and marching cubes share it.

use crate::{executor::Executor, math::floor};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Nodes along a block's edge.
pub const BLOCK: usize = 8;
/// Nodes in a block.
pub const BLOCK_NODES: usize = BLOCK * BLOCK * BLOCK;
/// Blocks that one job of an [`crate::Executor`] works on. The number affects no result.
pub(crate) const BLOCKS_PER_JOB: usize = 64;

/// A uniform grid of which only some blocks of 8³ nodes are stored.
///
/// Node (x, y, z) lies at `origin + voxel * (x, y, z)`. The owner of the grid keeps the values in an array of its own:
/// block after block in the order of `blocks`, and x fastest within a block.
#[derive(Debug, Clone, Default)]
pub struct SparseGrid {
    /// Position of node (0, 0, 0).
    pub origin: Vec3,
    /// Spacing of the nodes, in scene units.
    pub voxel: f32,
    /// Size in blocks.
    pub dims: [u32; 3],
    /// Coordinates of the stored blocks, sorted by z, then y, then x.
    pub blocks: Vec<[u16; 3]>,
    table: Vec<u32>,
}

/// The cube between eight nodes that contains a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    /// The node with the smallest coordinates.
    first: [i32; 3],
    /// Position of the point between that node, 0, and the next one, 1, along each axis.
    fraction: [f32; 3],
}

impl SparseGrid {
    /// Slot of a block that is not stored and lies outside the object.
    pub const OUTSIDE: u32 = u32::MAX;
    /// Slot of a block that is not stored and lies inside the object.
    pub const INSIDE: u32 = u32::MAX - 1;

    /// A grid of `dims` blocks. `keep` is called for each block, with x fastest and z slowest. A block is stored unless
    /// `keep` returns [`Self::OUTSIDE`] or [`Self::INSIDE`].
    pub fn new(origin: Vec3, voxel: f32, dims: [u32; 3], mut keep: impl FnMut([u32; 3]) -> u32) -> Self {
        Self::keeping(origin, voxel, dims, &mut keep)
    }

    /// [`Self::new`]. `keep` is not a type parameter, so that this is compiled once.
    fn keeping(origin: Vec3, voxel: f32, dims: [u32; 3], keep: &mut dyn FnMut([u32; 3]) -> u32) -> Self {
        let mut grid = Self {
            origin,
            voxel,
            dims,
            blocks: Vec::new(),
            table: vec![Self::OUTSIDE; (dims[0] * dims[1] * dims[2]) as usize],
        };
        let mut slot = 0;
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                for x in 0..dims[0] {
                    let state = keep([x, y, z]);
                    grid.table[slot] = if state >= Self::INSIDE {
                        state
                    } else {
                        grid.blocks.push([x as u16, y as u16, z as u16]);
                        grid.blocks.len() as u32 - 1
                    };
                    slot += 1;
                }
            }
        }
        grid
    }

    /// Calls `job` for each part of the stored blocks with an iterator over the coordinates of the blocks and the values of
    /// their nodes in `field`.
    pub(crate) fn for_each_part<T: Send>(
        &self,
        field: &mut [T],
        executor: &dyn Executor,
        job: impl Fn(&mut dyn Iterator<Item = (&[u16; 3], &mut [T])>) + Sync,
    ) {
        let parts = self.blocks.chunks(BLOCKS_PER_JOB).zip(field.chunks_mut(BLOCKS_PER_JOB * BLOCK_NODES));
        executor
            .map_parts(parts, |_, (blocks, field)| job(&mut blocks.iter().zip(field.chunks_exact_mut(BLOCK_NODES))));
    }

    /// Slot of a block, or [`Self::INSIDE`] or [`Self::OUTSIDE`] if it is not stored. Blocks beyond the grid are
    /// outside.
    #[inline]
    pub fn slot(&self, x: i32, y: i32, z: i32) -> u32 {
        let [w, h, d] = self.dims;
        if (x as u32) < w && (y as u32) < h && (z as u32) < d {
            self.table[((z as u32 * h + y as u32) * w + x as u32) as usize]
        } else {
            Self::OUTSIDE
        }
    }

    /// Slot of the block that contains a node, and the node's index within the block.
    #[inline]
    pub fn locate(&self, x: i32, y: i32, z: i32) -> (u32, usize) {
        let (m, s) = (BLOCK as i32 - 1, BLOCK.trailing_zeros());
        let local = ((z & m) << (2 * s)) | ((y & m) << s) | (x & m);
        (self.slot(x >> s, y >> s, z >> s), local as usize)
    }

    /// Value at a node. In blocks that are not stored it is `outside` or `inside`.
    #[inline]
    pub fn value(&self, values: &[f32], x: i32, y: i32, z: i32, outside: f32, inside: f32) -> f32 {
        match self.locate(x, y, z) {
            (Self::OUTSIDE, _) => outside,
            (Self::INSIDE, _) => inside,
            (slot, local) => values[slot as usize * BLOCK_NODES + local],
        }
    }

    /// Position of a node.
    #[inline]
    pub fn node(&self, x: i32, y: i32, z: i32) -> Vec3 {
        self.origin + Vec3::new(x as f32, y as f32, z as f32) * self.voxel
    }

    /// Trilinear interpolation of the node values at a point.
    #[inline]
    pub fn interpolate(&self, values: &[f32], p: Vec3, outside: f32, inside: f32) -> f32 {
        self.interpolate_in(values, &self.cell(p), outside, inside)
    }

    /// The cell that contains a point.
    #[inline]
    pub(crate) fn cell(&self, p: Vec3) -> Cell {
        let q = (p - self.origin) / self.voxel;
        let first = q.to_array().map(floor);
        Cell { first, fraction: core::array::from_fn(|k| q[k] - first[k] as f32) }
    }

    /// Slot of the block that contains the first node of a cell, see [`Self::slot`].
    #[inline]
    pub(crate) fn slot_of(&self, cell: &Cell) -> u32 {
        let [x, y, z] = cell.first.map(|v| v >> BLOCK.trailing_zeros());
        self.slot(x, y, z)
    }

    /// [`Self::interpolate`] at a point whose cell is known.
    #[inline]
    pub(crate) fn interpolate_in(&self, values: &[f32], cell: &Cell, outside: f32, inside: f32) -> f32 {
        let Cell { first, fraction: [fx, fy, fz] } = *cell;
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let m = BLOCK as i32 - 1;
        if first.iter().all(|v| v & m != m) {
            // All eight nodes lie in one block.
            let [x, y, z] = first;
            let (slot, local) = self.locate(x, y, z);
            return match slot {
                Self::OUTSIDE => outside,
                Self::INSIDE => inside,
                _ => {
                    let v = &values[slot as usize * BLOCK_NODES + local..][..BLOCK * BLOCK + BLOCK + 2];
                    let row = |i: usize| lerp(v[i], v[i + 1], fx);
                    let plane = |i: usize| lerp(row(i), row(i + BLOCK), fy);
                    lerp(plane(0), plane(BLOCK * BLOCK), fz)
                }
            };
        }
        let v = self.corners(values, first, outside, inside);
        let row = |i: usize| lerp(v[i], v[i + 1], fx);
        lerp(lerp(row(0), row(2), fy), lerp(row(4), row(6), fy), fz)
    }

    /// Values at the eight corners of the cell above a node, x fastest. Only as many blocks are looked up as the cell touches.
    #[inline]
    fn corners(&self, values: &[f32], first: [i32; 3], outside: f32, inside: f32) -> [f32; 8] {
        let (m, s) = (BLOCK as i32 - 1, BLOCK.trailing_zeros());
        let block = first.map(|v| v >> s);
        // Whether the cell reaches into the next block, and the indices of both nodes within their blocks.
        let crosses = first.map(|v| v & m == m);
        let local: [[usize; 2]; 3] =
            [0, 1, 2].map(|k| [first[k] & m, (first[k] + 1) & m].map(|v| (v as usize) << (s * k as u32)));
        let mut corners = [0.0; 8];
        let mut slots = [Self::OUTSIDE; 8];
        for i in 0..8 {
            let step: [usize; 3] = [i & 1, i >> 1 & 1, i >> 2];
            let [next_x, next_y, next_z] = [0, 1, 2].map(|k| step[k] == 1 && crosses[k]);
            // The corner in the same block with the lowest number.
            let same = usize::from(next_x) | usize::from(next_y) << 1 | usize::from(next_z) << 2;
            if same == i {
                let [x, y, z] = block;
                slots[i] = self.slot(x + i32::from(next_x), y + i32::from(next_y), z + i32::from(next_z));
            }
            corners[i] = match slots[same] {
                Self::OUTSIDE => outside,
                Self::INSIDE => inside,
                slot => {
                    values[slot as usize * BLOCK_NODES + (local[0][step[0]] | local[1][step[1]] | local[2][step[2]])]
                }
            };
        }
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blocks of all three kinds side by side, and points in and around all of them.
    #[test]
    fn interpolation_is_that_of_the_eight_nodes_one_by_one() {
        let state = |[x, y, z]: [u32; 3]| {
            [0, SparseGrid::INSIDE, 0, SparseGrid::OUTSIDE, 0][((x + 2 * y + 3 * z) % 5) as usize]
        };
        let grid = SparseGrid::new(Vec3::new(-1.0, 0.5, 2.0), 0.25, [3, 4, 3], state);
        let values: Vec<f32> = (0..grid.blocks.len() * BLOCK_NODES).map(|i| (i * 7919 % 1013) as f32 - 500.0).collect();
        let (outside, inside) = (-900.0, 900.0);
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let mut crossing = 0;
        for i in 0..40_000 {
            // The periods have no common divisor, so that the points spread over a box that is larger than the grid.
            let along = |period: usize, n: f32| (i * 317 % period) as f32 / period as f32 * (n + 4.0) - 2.0;
            let q = Vec3::new(along(1009, 24.0), along(1013, 32.0), along(1019, 24.0));
            let p = grid.origin + q * grid.voxel;
            let q = (p - grid.origin) / grid.voxel;
            let [x, y, z] = q.to_array().map(floor);
            let [fx, fy, fz] = [q.x - x as f32, q.y - y as f32, q.z - z as f32];
            let at = |dx, dy, dz| grid.value(&values, x + dx, y + dy, z + dz, outside, inside);
            let row = |dy, dz| lerp(at(0, dy, dz), at(1, dy, dz), fx);
            let expected = lerp(lerp(row(0, 0), row(1, 0), fy), lerp(row(0, 1), row(1, 1), fy), fz);
            assert_eq!(grid.interpolate(&values, p, outside, inside), expected, "{p}");
            crossing += usize::from([x, y, z].iter().any(|v| v & 7 == 7));
        }
        assert!((10_000..20_000).contains(&crossing), "{crossing} cells reach into other blocks");
    }
}
