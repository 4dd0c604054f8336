//! Mistakes that concern all cameras. With them the silhouettes contradict each other, and without them they agree: poses in
//! another convention, K of pictures of another size, pictures in another order than the cameras.

use super::state::Frame;
use crate::{
    camera::{Camera, Pinhole},
    error::{Error, Result},
    executor::Executor,
    hull::{HullParams, VisualHull, compare},
    left_out::LeftOut,
    math::quantile,
    memory,
    progress::Progress,
    rig::{Convention, Rig, meeting_point, other_intrinsics},
    surface::drop_small_components,
    view::View,
    workspace::Workspace,
};
use alloc::{
    format,
    string::{String, ToString},
    vec,
    vec::Vec,
};
use core::{mem::take, ops::Deref};

/// Spacing of the hull's grid in a trial, in pixels of footprint.
const TRIAL_VOXEL_PIXELS: f32 = 4.0;

/// A mistake that may have been made.
struct Mistake {
    /// What it is, and what to do.
    remedy: String,
    /// The cameras without the mistake, by index.
    cameras: Vec<Camera>,
    /// For each camera, by index, the camera that has its picture.
    pictures: Vec<usize>,
}

impl<R: Deref<Target = Rig> + Sync> Frame<R> {
    /// An error that names a mistake without which the silhouettes agree: three quarters of them overlap with their hull by more
    /// than `convincing`.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub(super) fn mistake(
        &mut self,
        convincing: f32,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Option<Error>> {
        let mut workspace = take(&mut self.memory.workspace);
        let mut best: Option<(f32, Mistake)> = None;
        let mut result = Ok(());
        for mistake in mistakes(self.rig.cameras()) {
            let views = self.without(&mistake);
            let smallest = self.params.meshing.smallest_component;
            let overlap = trial(&views, smallest, self.memory.limit(), executor, &mut workspace, progress);
            match overlap {
                Ok(overlap) if overlap > best.as_ref().map_or(convincing, |(best, _)| *best) => {
                    best = Some((overlap, mistake));
                }
                Ok(_) => {}
                Err(cancelled) => {
                    result = Err(cancelled);
                    break;
                }
            }
        }
        self.memory.workspace = workspace;
        result?;
        Ok(best.map(|(overlap, mistake)| Error::Cameras {
            problem: format!(
                "{}: with the cameras as given the silhouettes contradict each other, and read that way they agree to {:.0} %",
                mistake.remedy,
                100.0 * overlap
            ),
        }))
    }

    /// The views that say something about the cameras, without a mistake.
    fn without(&self, mistake: &Mistake) -> Vec<View> {
        let origin = meeting_point(mistake.cameras.iter());
        let without = |view: &View| {
            let camera = self.rig.order()[usize::from(view.index)] as usize;
            let picture = &self.views[self.rig.place(mistake.pictures[camera])?];
            let pinhole = Pinhole::new(&mistake.cameras[camera], origin).at_octave(picture.octave);
            is_evidence(picture)
                .then(|| View::of_silhouette(view.index, pinhole, picture.silhouette_as_given().cloned()))
        };
        self.views.iter().filter_map(without).collect()
    }
}

/// The mistakes that may have been made, the most common ones first.
fn mistakes(cameras: &[Camera]) -> Vec<Mistake> {
    let in_order: Vec<usize> = (0..cameras.len()).collect();
    let mut mistakes = Vec::new();
    for convention in Convention::OTHERS {
        if let Some((_, cameras)) = convention.meeting(cameras) {
            mistakes.push(Mistake { remedy: convention.remedy().into(), cameras, pictures: in_order.clone() });
        }
    }
    if let Some((remedy, cameras)) = other_intrinsics(cameras) {
        mistakes.push(Mistake { remedy, cameras, pictures: in_order });
    }
    for (order, pictures) in orders(cameras) {
        let remedy = format!(
            "the pictures look as if they were in another order than the cameras, {order}: give each camera its own picture \
             and mask"
        );
        mistakes.push(Mistake { remedy, cameras: cameras.to_vec(), pictures });
    }
    mistakes
}

/// Orders in which pictures may have been given instead of that of the cameras. Pictures of different sizes cannot be exchanged
/// unnoticed.
fn orders(cameras: &[Camera]) -> Vec<(&'static str, Vec<usize>)> {
    let size = |camera: &Camera| (camera.width, camera.height);
    if cameras.iter().any(|camera| size(camera) != size(&cameras[0])) {
        return Vec::new();
    }
    let count = cameras.len();
    let all = |picture: &dyn Fn(usize) -> usize| (0..count).map(picture).collect::<Vec<_>>();
    let mut orders = vec![
        ("off by one", all(&|camera| (camera + 1) % count)),
        ("off by one", all(&|camera| (camera + count - 1) % count)),
        ("the reverse one", all(&|camera| count - 1 - camera)),
    ];
    // Names such as cam1, cam10, cam2, counted from 0 and from 1, either of the cameras or of the pictures.
    for first in [0, 1] {
        let names: Vec<String> = (first..first + count).map(|number| number.to_string()).collect();
        let ranks = all(&|camera| names.iter().filter(|name| **name < names[camera]).count());
        let mut inverse = ranks.clone();
        ranks.iter().enumerate().for_each(|(camera, &rank)| inverse[rank] = camera);
        if ranks.iter().enumerate().any(|(camera, &rank)| camera != rank) {
            orders.extend([ranks, inverse].map(|pictures| ("that of their names as text", pictures)));
        }
    }
    orders
}

/// Whether a view's silhouette says something about the cameras: with wrong ones views contradict each other, or look past what
/// the others see.
pub(super) fn is_evidence(view: &View) -> bool {
    matches!(view.left_out, None | Some(LeftOut::Contradicts | LeftOut::BesidePicture))
}

/// The overlap with their hull that three quarters of the silhouettes exceed, 0 if they have no hull. The median would not do: if
/// half of the masks show too much, the others agree with them whatever the cameras are. Components of the hull smaller than
/// the share `smallest` are dropped. `limit` is that of memory, in bytes.
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
) -> Result<f32> {
    let params = HullParams { voxel_pixels: TRIAL_VOXEL_PIXELS };
    let carved = VisualHull::with_workspace(views, &params, limit, workspace, executor, progress);
    let hull = match carved.and_then(|hull| memory::check_hull(views, &hull, limit).map(|()| hull)) {
        Ok(hull) => hull,
        Err(Error::Cancelled) => return Err(Error::Cancelled),
        Err(_) => return Ok(0.0),
    };
    let mut mesh = hull.mesh(workspace, executor);
    drop_small_components(&mut mesh, smallest, workspace);
    let found = compare(views, &mesh, executor, progress)?;
    hull.recycle_into(workspace);
    mesh.recycle_into(workspace);
    Ok(quantile(found.into_iter().filter_map(|found| found.overlap), [1, 4]).unwrap_or(0.0))
}
