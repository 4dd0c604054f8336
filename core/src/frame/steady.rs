//! The mean of a finished frame and its neighbours in time.

use super::state::{Frame, no_hull};
use crate::{
    error::Result,
    executor::Executor,
    lost_part::{Beside, look_beyond, may_have_lost_part},
    memory,
    point_cloud::Mesh,
    progress::Progress,
    rig::Rig,
    sort::short,
    stage::Stage,
    steady::{SteadyParams, steady},
};
use alloc::vec::Vec;
use core::ops::Deref;

impl<R: Deref<Target = Rig>> Frame<R> {
    /// The cameras whose silhouettes the other views have overruled, by their index in [`Rig::cameras`], in ascending order:
    /// they are set aside or have been completed. Empty before the hull is complete.
    pub fn overruled(&self) -> Vec<u32> {
        let views = self.views().iter().filter(|view| view.is_set_aside() || view.added > 0);
        let mut cameras: Vec<u32> = views.map(|view| self.rig.order()[usize::from(view.index)]).collect();
        short(&mut cameras);
        cameras
    }
}

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

    /// Whether the frame may have lost a part that the frames before and after it have ([`crate::lost_part`]): its finished mesh
    /// has no surface near a part that both of theirs have, or its other views have overruled two silhouettes or more that
    /// those of the neighbours have not overruled. If so, a frame that is made by [`Frame::read_views_between`] has the part, if
    /// the pictures show it.
    ///
    /// # Errors
    /// [`crate::Error::WrongOrder`] if [`Stage::Colour`] is not complete.
    pub fn may_have_lost_part(&self, neighbours: [Beside; 2], executor: &dyn Executor) -> Result<bool> {
        self.require(Stage::Colour)?;
        let own = Beside { mesh: &self.mesh, overruled: &self.overruled() };
        Ok(may_have_lost_part(own, neighbours, executor))
    }

    /// Whether the frame may have lost a part together with the one before or after it, so that a frame further away must take
    /// that one's place in [`Frame::may_have_lost_part`] and [`Frame::read_views_between`]: first whether that is the frame
    /// before `before`, then whether it is the one after `after`. They are asked if the other neighbour has a part that both
    /// lack, or if two silhouettes or more were overruled in both and not in the other. The answer is nearly always no, unless
    /// parts move fast.
    ///
    /// # Errors
    /// [`crate::Error::WrongOrder`] if [`Stage::Colour`] is not complete.
    pub fn look_beyond(&self, neighbours: [Beside; 2], executor: &dyn Executor) -> Result<[bool; 2]> {
        self.require(Stage::Colour)?;
        let own = Beside { mesh: &self.mesh, overruled: &self.overruled() };
        Ok(look_beyond(own, neighbours, executor))
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
