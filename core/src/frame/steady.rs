//! The mean of a finished frame and its neighbours in time.

use super::state::{Frame, no_hull};
use crate::{
    error::Result,
    executor::Executor,
    memory,
    point_cloud::Mesh,
    progress::Progress,
    rig::Rig,
    stage::Stage,
    steady::{SteadyParams, steady},
};
use core::ops::Deref;

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// Averages the finished mesh with those of neighbouring frames, such as the one before and the one after it: see
    /// [`crate::steady`]. [`Frame::mesh`] is then the mean, and so are the forms that are made of it. `neighbours` are the
    /// other frames' [`Frame::own_mesh`], of a rig with the same cameras. A later call replaces the result of an earlier one.
    ///
    /// # Errors
    /// [`crate::Error::WrongOrder`] if [`Stage::Colour`] is not complete, [`crate::Error::OutOfMemory`], and
    /// [`crate::Error::Cancelled`].
    pub fn steady(
        &mut self,
        neighbours: &[&Mesh],
        params: &SteadyParams,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<()> {
        self.require(Stage::Colour)?;
        progress.on_stage_start(Stage::Steady);
        let result = self.average(neighbours, params, executor, progress);
        progress.on_stage_end(Stage::Steady);
        self.steadied = Some(result?);
        self.complete_steady();
        Ok(())
    }

    fn average(
        &self,
        neighbours: &[&Mesh],
        params: &SteadyParams,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Mesh> {
        let hull = self.hull.as_ref().ok_or_else(no_hull)?;
        let frame =
            || memory::needed(self.views(), hull, &self.intermediates.hull, &self.params, self.kept.whole_views);
        memory::check_steady(frame, &self.mesh, neighbours, self.memory.limit())?;
        let mut mesh = self.mesh.clone();
        steady(&mut mesh, neighbours, hull.footprint(), params, executor, progress)?;
        Ok(mesh)
    }
}
