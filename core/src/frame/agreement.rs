//! Carves the hull from the views that agree. Views that contradict the others are found, and the hull is carved again
//! without their silhouettes.

use super::state::Frame;
use crate::{
    error::{Error, Result},
    hull::{AgreementParams, Completed, completed, contradicting, uncovered_share},
    left_out::LeftOut,
    progress::Progress,
    rig::{MIN_VIEWS, Rig},
    view::View,
};
use core::{mem::take, ops::Deref};

/// Largest number of times that the hull is carved again.
const ROUNDS: u32 = 3;

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// Carves the hull (§0). The silhouettes of views that contradict the others are set aside. If not only the matte but
    /// the camera must be wrong, the view is left out.
    ///
    /// # Errors
    /// Those of carving.
    pub(super) fn carve_agreeing(&mut self, progress: &dyn Progress) -> Result<()> {
        self.views.iter_mut().for_each(View::take_back);
        let mut carved = self.carve_hull(progress);
        let Some(params) = self.params.agreement else { return carved };
        let silhouettes = self.views.iter().filter(|view| view.is_used() && view.silhouette.is_some()).count();
        let most = (params.largest_share * silhouettes as f32) as usize;
        for _ in 0..ROUNDS {
            if !matches!(carved, Ok(()) | Err(Error::EmptyHull)) {
                return carved;
            }
            if carved.is_err() {
                take(&mut self.intermediates.hull).recycle_into(&mut self.memory.workspace);
            }
            let room = most.saturating_sub(self.views.iter().filter(|view| view.is_set_aside()).count());
            let guilty = contradicting(
                &self.views,
                &self.intermediates.hull,
                params.blame,
                room.min(silhouettes.saturating_sub(MIN_VIEWS as usize)),
                &mut self.memory.workspace,
                progress,
            )?;
            if guilty.is_empty() {
                break;
            }
            for place in guilty {
                let view = &mut self.views[usize::from(place)];
                view.given = view.silhouette.take();
            }
            carved = self.carve_hull(progress);
        }
        carved?;
        if self.complete_silhouettes(progress)? {
            self.carve_hull(progress)?;
        }
        self.leave_out_moved(&params);
        Ok(())
    }

    /// Adds to the silhouettes what they lack. Returns whether one has changed.
    fn complete_silhouettes(&mut self, progress: &dyn Progress) -> Result<bool> {
        let Some(hull) = &self.hull else { return Ok(false) };
        let completed = completed(&self.views, hull.bounds(), hull.footprint(), progress)?;
        let any = !completed.is_empty();
        for Completed { place, silhouette, added } in completed {
            let view = &mut self.views[usize::from(place)];
            view.given = view.silhouette.replace(silhouette);
            view.added = added;
        }
        Ok(any)
    }

    /// Leaves out the views whose silhouettes, besides lacking something, show what the hull of the others does not
    /// have: their cameras are not where the calibration says, or their pictures are of another instant.
    fn leave_out_moved(&mut self, params: &AgreementParams) {
        for view in &mut self.views {
            let Some(silhouette) = view.given.as_ref().filter(|_| view.is_set_aside()) else { continue };
            if uncovered_share(&view.camera, silhouette, &self.intermediates.hull) > params.uncovered {
                view.take_back();
                view.left_out = Some(LeftOut::Contradicts);
            }
        }
    }
}
