//! Checks of a frame's views against each other, around the carving of the hull: inverted masks, cameras that do not see
//! the object, and silhouettes that contradict each other.

use super::{mistakes::is_evidence, state::Frame};
use crate::{
    error::{Error, Result},
    executor::Executor,
    hull::{Agreement, Comparison, compare},
    left_out::LeftOut,
    math::median,
    progress::{Onward, Progress},
    rig::Rig,
    view::View,
};
use alloc::{format, vec::Vec};
use core::ops::Deref;

/// A silhouette that touches more than this share of its picture's border is that of an inverted mask, or of an object
/// that leaves the picture on most sides.
const INVERTED_BORDER: f32 = 0.6;
/// If the median overlap of silhouettes and hull is smaller than this, all cameras may be wrong in the same way. Captures with a
/// wrong matte or a camera that was moved have more, but so have few cameras, whatever their poses.
const DOUBTFUL_OVERLAP: f32 = 0.9;
/// They are if most silhouettes overlap by more than this without the mistake, and what does not overlap is less than this share
/// of what it was.
const CONVINCING_OVERLAP: f32 = 0.75;
const CONVINCING_REST: f32 = 0.6;
/// If more views are at fault than may be set aside, and the median overlap is smaller than this, the hull has little in common
/// with the object.
const HOPELESS_OVERLAP: f32 = 0.6;

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// Carves the hull (§0) and checks the views against it.
    ///
    /// # Errors
    /// Those of carving, [`Error::MasksInverted`] and [`Error::Cameras`].
    pub(super) fn carve_and_check(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        let progress = &Onward::new(progress);
        for view in &mut self.views {
            view.left_out = view.left_out.filter(|reason| !reason.is_found_with_hull());
        }
        self.compared.clear();
        self.agreement = Agreement::default();
        self.exchanged.clear();
        let doubtful = set_aside_inverted(&mut self.views)?;
        self.carve_and_compare(executor, progress)?;
        let mut again = false;
        for place in doubtful {
            // Of an object that leaves the picture on most sides, the hull covers the silhouette and not its inverse.
            let Comparison { overlap, inverted, .. } = self.compared[place];
            if inverted <= overlap {
                self.views[place].left_out = None;
                again = true;
            }
        }
        for (view, found) in self.views.iter_mut().zip(&self.compared) {
            if view.is_used() && !found.in_picture {
                view.left_out = Some(LeftOut::BesidePicture);
                // What its silhouette shows is not the object, and must not be asked for.
                again |= view.silhouette.is_some();
            }
        }
        if again {
            self.carve_and_compare(executor, progress)?;
        }
        if self.params.agreement.is_some() {
            self.leave_out_moved(executor, progress)?;
        }
        let overlaps = self.views.iter().zip(&self.compared).filter(|(view, _)| is_evidence(view));
        let overlap = median(overlaps.filter_map(|(_, found)| found.overlap)).unwrap_or(1.0);
        if overlap < DOUBTFUL_OVERLAP {
            let convincing = CONVINCING_OVERLAP.max(1.0 - CONVINCING_REST * (1.0 - overlap));
            if let Some(error) = self.mistake(convincing, executor, progress)? {
                return Err(error);
            }
            if self.agreement.too_many && overlap < HOPELESS_OVERLAP {
                return Err(contradictory(overlap));
            }
        }
        Ok(())
    }

    /// Leaves out cameras that were moved by a pixel or two, one after the other: without one, others fit again.
    fn leave_out_moved(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        let most = self.most_moved();
        for _ in 0..most {
            let Some(place) = self.moved(most) else { break };
            self.views[usize::from(place)].left_out = Some(LeftOut::Contradicts);
            self.carve_and_compare(executor, progress)?;
        }
        Ok(())
    }

    fn carve_and_compare(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        match self.carve_agreeing(executor, progress) {
            Err(Error::EmptyHull) => {
                let error = self.mistake(CONVINCING_OVERLAP, executor, progress)?;
                return Err(error.unwrap_or(Error::EmptyHull));
            }
            result => result?,
        }
        self.compared = compare(&self.views, &self.intermediates.hull, executor, progress)?;
        Ok(())
    }
}

fn contradictory(overlap: f32) -> Error {
    let problem = format!(
        "the silhouettes contradict each other, more of them than can be left out: half of them agree to less than {:.0} %. Check \
         that pictures and masks are in the order of the cameras and of the same instant, that K belongs to pictures of this \
         size, and that R, t are world to camera, with x right, y down and z forward",
        100.0 * overlap
    );
    Error::Cameras { problem }
}

/// Leaves out the views whose silhouettes touch most of their pictures' borders while those of most others do not. Returns
/// their places: whether their masks are inverted is known when the others' hull is.
///
/// # Errors
/// [`Error::MasksInverted`] if at least half of the silhouettes do.
fn set_aside_inverted(views: &mut [View]) -> Result<Vec<usize>> {
    let given = || views.iter().enumerate().filter(|(_, view)| view.is_used());
    let silhouettes: Vec<_> = given().filter_map(|(place, view)| Some((place, view.silhouette.as_ref()?))).collect();
    let touching: Vec<_> =
        silhouettes.iter().filter(|(_, silhouette)| silhouette.border_share() > INVERTED_BORDER).collect();
    if !touching.is_empty() && 2 * touching.len() >= silhouettes.len() {
        return Err(Error::MasksInverted { inverted: touching.len() as u32, given: silhouettes.len() as u32 });
    }
    // A silhouette that fills its picture carves nothing.
    let doubtful: Vec<usize> =
        touching.iter().filter(|(_, silhouette)| !silhouette.is_full()).map(|&&(place, _)| place).collect();
    for &place in &doubtful {
        views[place].left_out = Some(LeftOut::MaskInverted);
    }
    Ok(doubtful)
}
