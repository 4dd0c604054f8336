//! The results of the stages before the final mesh.

use crate::{
    point_cloud::{Mesh, PointCloud},
    workspace::Workspace,
};
use alloc::vec::Vec;

/// Results of the stages before the final mesh. Positions are relative to the rig's origin.
#[derive(Debug, Clone, Default)]
pub struct Intermediates {
    /// The visual hull's own mesh (§0).
    pub hull: Mesh,
    /// The mesh that guided detection. Empty if there was none.
    pub coarse: Mesh,
    /// One cleaned point cloud per view, in the rig's order (§4).
    pub detected: Vec<PointCloud>,
    /// Frontier points (§4.4).
    pub frontier: PointCloud,
    /// Implicit points (§4.4).
    pub implicit: PointCloud,
    /// The merged cloud (§5).
    pub merged: PointCloud,
}

impl Intermediates {
    /// Returns the memory to a workspace.
    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        self.hull.recycle_into(workspace);
        self.coarse.recycle_into(workspace);
        workspace.recycle(self.merged);
    }
}
