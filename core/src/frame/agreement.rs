//! The hull of the views that agree.

use super::state::Frame;
use crate::{
    error::Result,
    executor::Executor,
    hull::{AgreementParams, Carving, Completed, apart, carve_agreeing, completed, contradicting, exchanged},
    left_out::LeftOut,
    point_cloud::Mesh,
    progress::Progress,
    rig::Rig,
    view::View,
    workspace::Workspace,
};
use core::ops::Deref;

/// Largest number of times that the hull is carved again without views that contradict the others.
const ROUNDS: u32 = 3;

impl<R: Deref<Target = Rig> + Sync> Carving for Frame<R> {
    fn carve(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        self.carve_hull(executor, progress)
    }

    fn parts(&mut self) -> (&mut [View], &mut Mesh, &mut Workspace) {
        (&mut self.views, &mut self.intermediates.hull, &mut self.memory.workspace)
    }
}

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// Carves the hull (§0). The silhouettes of views that contradict the others are set aside. If not only the matte but
    /// the camera must be wrong, the view is left out.
    ///
    /// # Errors
    /// Those of carving.
    pub(super) fn carve_agreeing(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        self.views.iter_mut().for_each(View::take_back);
        let agreement = self.params.agreement;
        let rounds = if agreement.is_some() { ROUNDS } else { 0 };
        self.agreement = carve_agreeing(self, agreement.as_ref(), rounds, executor, progress)?;
        let Some(params) = agreement else { return Ok(()) };
        if self.complete_silhouettes(executor, progress)? {
            self.carve_hull(executor, progress)?;
            let (views, mesh, workspace) = self.parts();
            let found = contradicting(views, mesh, AgreementParams::BLAME, workspace, executor, progress)?;
            self.agreement.contradicting = found.places;
        }
        let mut wrong = apart(&self.views, &self.intermediates.hull, &params, executor);
        self.exchanged = exchanged(&self.views, &self.intermediates.hull, executor, progress)?;
        wrong.extend(self.exchanged.iter().flatten());
        for place in wrong {
            let view = &mut self.views[usize::from(place)];
            view.take_back();
            view.left_out = Some(LeftOut::Contradicts);
        }
        Ok(())
    }

    /// Adds to the silhouettes what they lack. Returns whether one has changed.
    fn complete_silhouettes(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<bool> {
        let Some(hull) = &self.hull else { return Ok(false) };
        let completed = completed(&self.views, hull.bounds(), hull.footprint(), executor, progress)?;
        let any = !completed.is_empty();
        for Completed { place, silhouette, added } in completed {
            let view = &mut self.views[usize::from(place)];
            view.given = view.silhouette.replace(silhouette);
            view.added = added;
        }
        Ok(any)
    }
}
