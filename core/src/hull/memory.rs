//! Memory for the hull's grid, which is checked before it is allocated. [`crate::memory`] has the whole formula.

use crate::{
    error::{Error, Result},
    view::View,
};

/// Bytes per pixel for colours, luma and silhouette.
pub(crate) const PER_PIXEL: u64 = 6;
/// Bytes per block of the bounding box of the hull's grid: the table of blocks, and room for their lists.
const PER_TABLE_BLOCK: u64 = 12;
/// Bytes per block of the hull's grid: the node values, the buffers of marching cubes and the block's part of the mesh.
pub(crate) const PER_BLOCK: u64 = 9000;

/// Number of pixels of all views.
pub(crate) fn pixels(views: &[View]) -> u64 {
    views.iter().map(|v| v.luma.len() as u64).sum()
}

/// Refuses a frame if the grid of its hull would need more than `limit` bytes. `table` is the number of blocks in the grid's
/// bounding box and `stored` that of the blocks that its surface may pass.
///
/// # Errors
/// [`crate::Error::OutOfMemory`].
pub(super) fn check_grid(views: &[View], table: u64, stored: u64, limit: Option<u64>) -> Result<()> {
    let grid = (PER_TABLE_BLOCK * table).max(PER_BLOCK * stored);
    within(|| PER_PIXEL * pixels(views) + grid, limit)
}

/// Refuses what needs more than `limit` bytes.
pub(crate) fn within(needed: impl FnOnce() -> u64, limit: Option<u64>) -> Result<()> {
    let Some(limit) = limit else { return Ok(()) };
    let needed = needed();
    if needed <= limit { Ok(()) } else { Err(Error::OutOfMemory { needed, limit }) }
}
