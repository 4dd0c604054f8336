//! The result of the solver, from which the surface is extracted.

use alloc::vec::Vec;

use crate::grid::SparseGrid;

/// χ is held at 0 where the distance outside the envelope exceeds this, in voxels. Up to that distance it is free, so
/// that a surface that coincides with the envelope keeps its smooth profile of χ.
pub(super) const MARGIN: f32 = 1.5;

/// A solution on the finest grid.
pub(in crate::mesh) struct Solution {
    pub(super) grid: SparseGrid,
    /// Signed distance to the surface in voxels, positive inside. Its median over the points is 0.
    pub(super) distances: Vec<f32>,
    /// For each node the variance of the points around it ([`super::calm`]), and the standard deviation at which half of the
    /// finest detail goes.
    pub(super) calm: Option<(Vec<f32>, f32)>,
    /// Signed distance to the envelope in voxels, if there is one. Exact within ± [`MARGIN`].
    pub(super) envelope: Option<Vec<f32>>,
}
