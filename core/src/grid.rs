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

impl SparseGrid {
    /// Slot of a block that is not stored and lies outside the object.
    pub const OUTSIDE: u32 = u32::MAX;
    /// Slot of a block that is not stored and lies inside the object.
    pub const INSIDE: u32 = u32::MAX - 1;

    /// A grid of `dims` blocks. `keep` is called for each block, with x fastest and z slowest. A block is stored unless
    /// `keep` returns [`Self::OUTSIDE`] or [`Self::INSIDE`].
    pub fn new(origin: Vec3, voxel: f32, dims: [u32; 3], mut keep: impl FnMut([u32; 3]) -> u32) -> Self {
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
        let q = (p - self.origin) / self.voxel;
        let (x, y, z) = (floor(q.x), floor(q.y), floor(q.z));
        let (fx, fy, fz) = (q.x - x as f32, q.y - y as f32, q.z - z as f32);
        let lerp = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let m = BLOCK as i32 - 1;
        if x & m != m && y & m != m && z & m != m {
            // All eight nodes lie in one block.
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
        let at = |dx, dy, dz| self.value(values, x + dx, y + dy, z + dz, outside, inside);
        let row = |dy, dz| lerp(at(0, dy, dz), at(1, dy, dz), fx);
        lerp(lerp(row(0, 0), row(1, 0), fy), lerp(row(0, 1), row(1, 1), fy), fz)
    }
}
