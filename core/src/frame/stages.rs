//! What a frame does in each stage: it passes in the results of earlier stages, calls the stage and stores its result.

use super::state::{Frame, no_hull};
use crate::{
    calibration::spot_check,
    coarse::coarse,
    colour::{self, Coloured},
    contours::{Contours, contours},
    error::Result,
    executor::Executor,
    hull::VisualHull,
    memory, merge, mesh,
    mesh::weigh,
    params::Method,
    point_cloud::Mesh,
    progress::Progress,
    report::Counts,
    rig::Rig,
    surface::drop_small_components,
};
use core::{mem::take, ops::Deref};

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// §0: the visual hull, and its mesh without stray components.
    pub(super) fn carve_hull(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        let limit = self.memory.limit();
        let workspace = &mut self.memory.workspace;
        if let Some(old) = self.hull.take() {
            old.recycle_into(workspace);
        }
        let hull = VisualHull::with_workspace(&self.views, &self.params.hull, limit, workspace, executor, progress)?;
        memory::check_hull(&self.views, &hull, limit)?;
        let mut mesh = hull.mesh(workspace, executor);
        self.counts.components_dropped =
            drop_small_components(&mut mesh, self.params.meshing.smallest_component, workspace);
        memory::check(&self.views, &hull, &mesh, &self.params, self.kept.whole_views, limit)?;
        (self.hull, self.intermediates.hull) = (Some(hull), mesh);
        Ok(())
    }

    /// §4.4: frontier and implicit points.
    pub(super) fn find_contours(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        if self.params.method == Method::Hull {
            return Ok(());
        }
        let (frontier, implicit) = (self.params.frontier.as_ref(), self.params.implicit.as_ref());
        let found = contours(self.context(progress)?, &self.intermediates.hull, frontier, implicit, executor)?;
        let Contours { mut frontier, mut implicit } = found;
        for cloud in [&mut frontier, &mut implicit] {
            weigh(cloud, self.params.meshing.weights.as_ref());
        }
        (self.counts.frontier, self.counts.implicit) = (frontier.len() as u32, implicit.len() as u32);
        (self.intermediates.frontier, self.intermediates.implicit) = (frontier, implicit);
        Ok(())
    }

    /// Sets the surface that guides detection: that of the prior or of the coarse pass, if there is one.
    pub(super) fn make_guide(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        take(&mut self.intermediates.coarse).recycle_into(&mut self.memory.workspace);
        self.forget_points();
        if self.params.method == Method::Hull {
            return Ok(());
        }
        if let Some(prior) = &self.prior {
            self.intermediates.coarse = Mesh::clone(&prior.surface);
        } else if let Some(params) = &self.params.coarse {
            let mut scratch = take(self.memory.detection.spare());
            let mut workspace = take(&mut self.memory.workspace);
            let made = coarse(
                self.context(progress)?,
                &self.intermediates.hull,
                &self.intermediates.frontier,
                params,
                &self.params.meshing,
                executor,
                &mut scratch,
                &mut workspace,
            );
            *self.memory.detection.spare() = scratch;
            self.memory.workspace = workspace;
            self.intermediates.coarse = made?;
        }
        Ok(())
    }

    /// §4.1 to §4.3, for all views that have not been detected yet.
    pub(super) fn detect_missing(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        let missing = self.undetected();
        let frame = &*self;
        let done = executor.map(missing.len(), |i| frame.detect_place(missing[i], progress));
        done.into_iter().collect::<Result<()>>()?;
        self.collect_points()
    }

    /// §5: merges all points into one cloud.
    pub(super) fn merge_points(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        if self.params.method == Method::Hull {
            return Ok(());
        }
        // Before the points of the views may be freed.
        self.calibration = spot_check(&self.rig, &self.windows, &self.intermediates.detected, executor);
        let all = self.intermediates.all_points(&mut self.kept, &mut self.memory.workspace);
        let mut counts = Counts::default();
        let neighbours = self.params.detection.search.neighbours;
        let merged = merge::merge(self.context(progress)?, all, neighbours, &self.params.merging, &mut counts)?;
        self.counts.set_merging(&counts);
        self.intermediates.merged = merged;
        Ok(())
    }

    /// §6: the mesh of the merged cloud.
    pub(super) fn mesh_points(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        if self.params.method == Method::Hull {
            self.mesh = self.intermediates.hull.clone();
            return Ok(());
        }
        let mut workspace = take(&mut self.memory.workspace);
        take(&mut self.mesh).recycle_into(&mut workspace);
        let hull = self.hull.as_ref().ok_or_else(no_hull)?;
        let params = &self.params.meshing;
        let voxel = params.voxel_pixels * hull.footprint();
        let points = self.intermediates.merged_points(&mut self.kept);
        let meshed = mesh::mesh(points, hull, voxel, params, &mut workspace, executor, progress);
        self.memory.workspace = workspace;
        let meshed = meshed?;
        (self.mesh, self.counts.components_dropped) = (meshed.mesh, meshed.components_dropped);
        self.intermediates.meshed(&self.kept, &mut self.memory.workspace);
        Ok(())
    }

    /// §7: the colours of the mesh.
    pub(super) fn colour_mesh(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        self.mesh.colours.clear();
        let Coloured { gains, uncovered } = colour::colour(
            &mut self.mesh,
            &self.windows,
            self.rig.gains(),
            &self.params.colour,
            &mut self.memory.workspace,
            executor,
            progress,
        )?;
        self.gains = self.rig.as_given(&gains);
        self.find_lacking(&uncovered);
        (self.counts.vertices, self.counts.faces) =
            (self.mesh.positions.len() as u32, self.mesh.triangles.len() as u32);
        Ok(())
    }
}
