//! The extent of the grids, and the distances of their nodes to the envelope.

use alloc::vec::Vec;
use glam::Vec3;

use crate::executor::Executor;
use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};
use crate::surface::{Envelope, SLOPE};
use crate::workspace::Workspace;

/// Extent of the domain relative to the bounds. χ is 0 at the border of the domain, which must not be too close to the
/// surface.
const ROOM: f32 = 1.3;

/// Largest number of blocks along an edge of the coarsest level.
const COARSEST: f32 = 4.0;

/// Size in blocks of the coarsest grid over bounds of this size, and the number of levels.
fn coarsest(size: Vec3, voxel: f32) -> ([u32; 3], usize) {
    let size = size * ROOM + 8.0 * voxel;
    // There are at least two levels, because the density of the points is measured one level above the finest.
    let mut levels = 2;
    while size.max_element() / (voxel * (BLOCK << (levels - 1)) as f32) > COARSEST {
        levels += 1;
    }
    let block = voxel * (BLOCK << (levels - 1)) as f32;
    ((size / block).to_array().map(|v| libm::ceilf(v) as u32), levels)
}

/// Number of blocks in the frame of the finest grid over bounds of this size.
pub(in crate::mesh) fn blocks(size: Vec3, voxel: f32) -> u64 {
    let (dims, levels) = coarsest(size, voxel);
    dims.iter().map(|&n| u64::from(n) << (levels - 1)).fold(1, u64::saturating_mul)
}

/// The frame of the finest grid over the bounds, without stored blocks, and the number of levels.
pub(super) fn domain(low: Vec3, high: Vec3, voxel: f32) -> (SparseGrid, usize) {
    let (dims, levels) = coarsest(high - low, voxel);
    let block = voxel * (BLOCK << (levels - 1)) as f32;
    let extent = Vec3::from_array(dims.map(|v| v as f32)) * block;
    let origin = (low + high - extent) * 0.5;
    let finest = SparseGrid::new(origin, voxel, dims.map(|v| v << (levels - 1)), |_| SparseGrid::OUTSIDE);
    (finest, levels)
}

/// Signed distance to the envelope at the stored nodes, in voxels, positive inside. It is exact where it is within ±
/// `reach`. Elsewhere only the sign is right, and that the magnitude exceeds `reach`. This saves most of the
/// evaluations.
pub(super) fn distances(
    grid: &SparseGrid,
    envelope: &dyn Envelope,
    reach: f32,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Vec<f32> {
    let mut distances = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
    grid.for_each_part(&mut distances, executor, |blocks| {
        for (block, out) in blocks {
            let first = block.map(|v| i32::from(v) * BLOCK as i32);
            cube(grid, envelope, reach, first, [0; 3], BLOCK, out);
        }
    });
    distances
}

/// Fills a cube of `side` nodes along each axis, at position `at` in the block that starts at node `first`.
fn cube(
    grid: &SparseGrid,
    envelope: &dyn Envelope,
    reach: f32,
    first: [i32; 3],
    at: [usize; 3],
    side: usize,
    out: &mut [f32],
) {
    let half = (side - 1) as f32 * 0.5;
    let centre: [f32; 3] = core::array::from_fn(|k| (first[k] + at[k] as i32) as f32 + half);
    // The distance from the centre to the farthest node is √3 times half the side.
    let clear = reach + SLOPE * 1.7321 * half;
    let place = grid.origin + Vec3::from_array(centre) * grid.voxel;
    let distance = envelope.distance_until(place, clear * grid.voxel) / grid.voxel;
    if side == 1 || distance.abs() > clear {
        for z in at[2]..at[2] + side {
            for y in at[1]..at[1] + side {
                let row = (z * BLOCK + y) * BLOCK + at[0];
                out[row..row + side].fill(distance);
            }
        }
        return;
    }
    for corner in 0..8 {
        let at = core::array::from_fn(|k| at[k] + (corner >> k & 1) * side / 2);
        cube(grid, envelope, reach, first, at, side / 2, out);
    }
}
