//! What the calibration needs of one frame: pictures, corners and outlines. None of it depends on where the cameras
//! stand.

use super::{
    corners::corners,
    model::Model,
    outline::{self, outline},
    patch::MARGIN,
    smooth::Smooth,
};
use crate::{
    error::Result,
    executor::Executor,
    hull::{HullParams, VisualHull},
    point_cloud::Mesh,
    progress::Progress,
    silhouette::Silhouette,
    surface::drop_small_components,
    view::View,
    workspace::Workspace,
};
use alloc::{sync::Arc, vec::Vec};

/// A corner must lie this far inside the silhouette, in pixels, so that its window shows little of the background.
const INSIDE: f32 = 5.0;
/// Parts of the hull that are smaller than this share of the largest are dropped.
const SMALLEST_PART: f32 = 0.01;

/// One view.
pub(super) struct Picture {
    pub(super) smooth: Smooth,
    pub(super) corners: Vec<[u16; 2]>,
    pub(super) silhouette: Option<Arc<Silhouette>>,
}

/// One frame, with its views in the rig's order.
pub(super) struct Instant {
    pub(super) pictures: Vec<Picture>,
    /// The outline of each view; empty without a silhouette.
    pub(super) outlines: Vec<Vec<outline::Corner>>,
}

impl Instant {
    pub(super) fn new(views: &[View], executor: &impl Executor) -> Self {
        let made = executor.map(views.len(), |i| {
            let view = &views[i];
            let (w, h) = (view.camera.width as usize, view.camera.height as usize);
            let smooth = Smooth::new(&view.luma, w, h);
            // A silhouette that was set aside may be that of a camera that was bumped.
            let silhouette = view.silhouette.clone().or_else(|| view.set_aside.clone());
            let deep = (INSIDE * Silhouette::UNITS) as i16;
            let wanted = |i: usize| {
                silhouette.as_ref().is_some_and(|s| s.distances()[i] > deep && s.distances()[i] != Silhouette::UNKNOWN)
            };
            let corners = corners(&smooth, MARGIN, wanted);
            let outline = silhouette.as_deref().map(outline).unwrap_or_default();
            (Picture { smooth, corners, silhouette }, outline)
        });
        let (pictures, outlines) = made.into_iter().unzip();
        Self { pictures, outlines }
    }

    /// The mesh of the visual hull as the cameras now stand, and its footprint. Cameras that are `excluded` do not carve.
    ///
    /// # Errors
    /// Those of [`VisualHull::new`].
    pub(super) fn hull(
        &self,
        models: &[Model],
        excluded: impl Fn(usize) -> bool,
        params: &HullParams,
        progress: &dyn Progress,
    ) -> Result<(Mesh, f32)> {
        let views: Vec<View> = (0..models.len())
            .map(|i| View {
                index: i as u16,
                camera: models[i].pinhole(),
                rgb: Vec::new(),
                luma: Vec::new(),
                silhouette: self.pictures[i].silhouette.clone().filter(|_| !excluded(i)),
                set_aside: None,
                left_out: None,
            })
            .collect();
        let mut workspace = Workspace::default();
        let hull = VisualHull::with_workspace(&views, params, &mut workspace, progress)?;
        let mut mesh = hull.mesh(&mut workspace);
        drop_small_components(&mut mesh, SMALLEST_PART, &mut workspace);
        Ok((mesh, hull.footprint()))
    }
}
