//! The results of the stages before the final mesh.

use crate::{
    error::{Error, Result},
    point_cloud::{Mesh, Point, PointCloud, concat},
    stage::Stage,
    workspace::Workspace,
};
use alloc::{borrow::Cow, format, vec::Vec};
use core::{iter::once, mem::take};

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

/// Records which intermediate results the frame has not freed yet.
#[derive(Debug)]
pub(super) struct Kept {
    /// Whether the frame keeps all results until it is dropped.
    pub(super) all: bool,
    /// Whether it keeps the whole views.
    pub(super) whole_views: bool,
    /// False once the views have been cut to the hull.
    pub(super) views: bool,
    /// False once merging has freed the points of the views, the frontier points and the implicit points.
    points: bool,
    /// False once meshing has taken the merged cloud.
    merged: bool,
}

impl Default for Kept {
    fn default() -> Self {
        Self { all: true, whole_views: true, views: true, points: true, merged: true }
    }
}

impl Kept {
    /// Checks that the results that a stage needs have not been freed. If the stage is the one that makes them again, they
    /// count as present from now on.
    ///
    /// # Errors
    /// [`Error::WrongOrder`].
    pub(super) fn check(&mut self, stage: Stage) -> Result<()> {
        if stage == Stage::Hull && !self.views {
            let problem = "the frame has cut its views to the hull, so that it cannot be carved again: begin a new frame, or keep the \
                           whole views";
            return Err(Error::WrongOrder { camera: None, problem: problem.into() });
        }
        let is_there = match stage {
            Stage::Coarse | Stage::Detect | Stage::Merge => self.points,
            Stage::Mesh => self.merged,
            _ => true,
        };
        if !is_there {
            let problem = format!(
                "the frame keeps no intermediate results, so that what `{}` needs is gone: run the stages from `{}` on again, \
                 or keep them",
                stage.name(),
                Stage::Contours.name()
            );
            return Err(Error::WrongOrder { camera: None, problem });
        }
        if stage == Stage::Contours {
            (self.points, self.merged) = (true, true);
        }
        Ok(())
    }
}

impl Intermediates {
    /// All points in one cloud: frontier points, those of the views, implicit points. Those that are not `kept` are freed
    /// one cloud after the other.
    pub(super) fn all_points(&mut self, kept: &mut Kept, workspace: &mut Workspace) -> PointCloud {
        let Self { frontier, detected, implicit, .. } = self;
        if kept.all {
            let clouds = once(&*frontier).chain(&*detected).chain(once(&*implicit));
            return concat(clouds.map(|cloud| &cloud[..]), workspace);
        }
        kept.points = false;
        let clouds = || once(&*frontier).chain(&*detected).chain(once(&*implicit));
        let mut all = workspace.empty(clouds().map(Vec::len).sum());
        for cloud in once(frontier).chain(detected).chain(once(implicit)) {
            all.extend_from_slice(cloud);
            *cloud = PointCloud::new();
        }
        all
    }

    /// The merged cloud for meshing, which frees it early if it is not kept.
    pub(super) fn merged_points(&mut self, kept: &mut Kept) -> Cow<'_, [Point]> {
        if kept.all {
            return Cow::Borrowed(&self.merged);
        }
        kept.merged = false;
        Cow::Owned(take(&mut self.merged))
    }

    /// Frees what no stage after meshing needs, unless it is kept.
    pub(super) fn meshed(&mut self, kept: &Kept, workspace: &mut Workspace) {
        if !kept.all {
            take(&mut self.coarse).recycle_into(workspace);
        }
    }

    /// Returns the memory to a workspace.
    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        self.hull.recycle_into(workspace);
        self.coarse.recycle_into(workspace);
        workspace.recycle(self.merged);
    }
}
