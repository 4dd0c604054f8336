//! Checks of a frame's views against each other, around the carving of the hull: inverted masks, cameras that do not see
//! the object, and poses in another convention.

use super::state::Frame;
use crate::{
    camera::Pinhole,
    error::{Error, Result},
    executor::Executor,
    hull::{Comparison, HullParams, VisualHull, compare},
    left_out::LeftOut,
    math::ordered,
    memory,
    progress::{Onward, Progress},
    rig::{Convention, Rig, meeting_point},
    surface::drop_small_components,
    view::View,
    workspace::Workspace,
};
use alloc::{format, vec::Vec};
use core::{mem::take, ops::Deref};

/// A silhouette that touches more than this share of its picture's border is that of an inverted mask, or of an object
/// that leaves the picture on most sides.
const INVERTED_BORDER: f32 = 0.6;
/// If the median overlap of silhouettes and hull is smaller than this, the poses may be given in another convention. Captures
/// with a wrong matte or a camera that was moved have more, but so have few cameras, whatever their poses.
const DOUBTFUL_OVERLAP: f32 = 0.9;
/// Poses are in another convention if the median overlap with them exceeds this, and what does not overlap is less than this
/// share of what it was.
const CONVINCING_OVERLAP: f32 = 0.75;
const CONVINCING_REST: f32 = 0.6;
/// Spacing of the hull's grid for another convention, in pixels of footprint.
const TRIAL_VOXEL_PIXELS: f32 = 4.0;

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
        self.contradicting.clear();
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
        let overlaps = self.views.iter().zip(&self.compared).filter(|(view, _)| is_evidence(view));
        let overlap = median(overlaps.filter_map(|(_, found)| found.overlap)).unwrap_or(1.0);
        if overlap < DOUBTFUL_OVERLAP {
            let convincing = CONVINCING_OVERLAP.max(1.0 - CONVINCING_REST * (1.0 - overlap));
            if let Some(error) = self.other_convention(convincing, executor, progress)? {
                return Err(error);
            }
        }
        Ok(())
    }

    fn carve_and_compare(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        match self.carve_agreeing(executor, progress) {
            Err(Error::EmptyHull) => {
                let error = self.other_convention(CONVINCING_OVERLAP, executor, progress)?;
                return Err(error.unwrap_or(Error::EmptyHull));
            }
            result => result?,
        }
        self.compared = compare(&self.views, &self.intermediates.hull, executor, progress)?;
        Ok(())
    }

    /// An error that names the convention of the poses, if the silhouettes agree in another one than the given: their median
    /// overlap exceeds `convincing`.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    fn other_convention(
        &mut self,
        convincing: f32,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Option<Error>> {
        let mut workspace = take(&mut self.memory.workspace);
        let mut best: Option<(f32, Convention)> = None;
        for convention in Convention::others() {
            let Some((_, read)) = convention.meeting(self.rig.cameras()) else { continue };
            let origin = meeting_point(read.iter());
            let posed = |view: &View| {
                let camera = &read[self.rig.order()[view.index as usize] as usize];
                let camera = Pinhole::new(camera, origin).at_octave(view.octave);
                View::of_silhouette(view.index, camera, view.silhouette_as_given().cloned())
            };
            let views: Vec<View> = self.views.iter().filter(|view| is_evidence(view)).map(posed).collect();
            let smallest = self.params.meshing.smallest_component;
            let limit = self.memory.limit();
            let overlap = match trial(&views, smallest, limit, executor, &mut workspace, progress) {
                Ok(overlap) => overlap.unwrap_or(0.0),
                Err(cancelled) => {
                    self.memory.workspace = workspace;
                    return Err(cancelled);
                }
            };
            if overlap > best.map_or(convincing, |(best, _)| best) {
                best = Some((overlap, convention));
            }
        }
        self.memory.workspace = workspace;
        Ok(best.map(|(overlap, convention)| Error::Cameras {
            problem: format!(
                "{}: with the poses as given the silhouettes contradict each other, and read that way they agree to {:.0} %",
                convention.remedy(),
                100.0 * overlap
            ),
        }))
    }
}

/// Whether a view's silhouette says something about the poses: with wrong poses views contradict each other, or look past what
/// the others see.
fn is_evidence(view: &View) -> bool {
    matches!(view.left_out, None | Some(LeftOut::Contradicts | LeftOut::BesidePicture))
}

/// Median overlap of the silhouettes with their hull, or `None` if they have no hull. Components of the hull smaller than the
/// share `smallest` are dropped. `limit` is that of memory, in bytes.
///
/// # Errors
/// [`Error::Cancelled`].
fn trial(
    views: &[View],
    smallest: f32,
    limit: Option<u64>,
    executor: &dyn Executor,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<Option<f32>> {
    let params = HullParams { voxel_pixels: TRIAL_VOXEL_PIXELS };
    let carved = VisualHull::with_workspace(views, &params, limit, workspace, executor, progress);
    let hull = match carved.and_then(|hull| memory::check_hull(views, &hull, limit).map(|()| hull)) {
        Ok(hull) => hull,
        Err(Error::Cancelled) => return Err(Error::Cancelled),
        Err(_) => return Ok(None),
    };
    let mut mesh = hull.mesh(workspace, executor);
    drop_small_components(&mut mesh, smallest, workspace);
    let found = compare(views, &mesh, executor, progress)?;
    hull.recycle_into(workspace);
    mesh.recycle_into(workspace);
    Ok(median(found.into_iter().filter_map(|found| found.overlap)))
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

/// The upper median.
pub(super) fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_unstable_by_key(|&v| ordered(v));
    values.get(values.len() / 2).copied()
}
