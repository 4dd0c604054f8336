//! What the solver hands on to the extraction of the surface.

use alloc::vec::Vec;

use crate::grid::SparseGrid;

/// χ is held at 0 farther outside the envelope than this, in voxels: a surface that coincides with the envelope keeps
/// the smooth profile that χ has across it.
pub(super) const MARGIN: f32 = 1.5;

/// A solution on the finest grid.
pub(in crate::mesh) struct Solution {
    pub(super) grid: SparseGrid,
    /// Distance to the surface in voxels, positive inside; its median at the points is 0.
    pub(super) distances: Vec<f32>,
    /// Signed distance to the envelope in voxels where it is within ± [`MARGIN`], if one was given.
    pub(super) envelope: Option<Vec<f32>>,
}
