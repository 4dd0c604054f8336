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
    hull::{AgreementParams, Carving, HullParams, VisualHull, apart, carve_agreeing},
    point_cloud::Mesh,
    progress::Progress,
    silhouette::Silhouette,
    surface::drop_small_components,
    view::View,
    workspace::Workspace,
};
use alloc::{sync::Arc, vec::Vec};

/// A corner must lie this far inside the silhouette, in pixels, so that its window shows little of the background.
pub(super) const INSIDE: f32 = 5.0;
/// Parts of the hull that are smaller than this share of the largest are dropped.
const SMALLEST_PART: f32 = 0.01;
/// Largest number of times that the hull is carved again without silhouettes that contradict it.
const ROUNDS: u32 = 2;

/// One view.
pub(super) struct Picture {
    pub(super) smooth: Smooth,
    pub(super) corners: Vec<[u16; 2]>,
    pub(super) silhouette: Option<Arc<Silhouette>>,
    /// Whether the camera has a picture in this frame.
    pub(super) is_there: bool,
}

/// One frame, with its views in the rig's order.
pub(super) struct Instant {
    pub(super) pictures: Vec<Picture>,
    /// The outline of each view; empty without a silhouette.
    pub(super) outlines: Vec<Vec<outline::Corner>>,
}

impl Instant {
    pub(super) fn new(views: &[View], executor: &dyn Executor) -> Self {
        let made = executor.map(views.len(), |i| {
            let view = &views[i];
            let (w, h) = (view.camera.width as usize, view.camera.height as usize);
            let smooth = Smooth::new(&view.luma, w, h);
            // The silhouette as it was given: one that contradicts the others may be that of a camera that was bumped.
            let silhouette = view.silhouette_as_given().cloned();
            let deep = (INSIDE * Silhouette::UNITS) as i16;
            let wanted = |i: usize| {
                silhouette.as_ref().is_some_and(|s| s.distances()[i] > deep && s.distances()[i] != Silhouette::UNKNOWN)
            };
            let corners = corners(&smooth, MARGIN, wanted);
            let outline = silhouette.as_deref().map(outline).unwrap_or_default();
            (Picture { smooth, corners, silhouette, is_there: !view.luma.is_empty() }, outline)
        });
        let (pictures, outlines) = made.into_iter().unzip();
        Self { pictures, outlines }
    }

    /// The views as the cameras now stand, without pictures. Cameras that are `excluded` have no silhouette.
    fn views(&self, models: &[Model], excluded: impl Fn(usize) -> bool) -> Vec<View> {
        let of = |i: usize| {
            let silhouette = self.pictures[i].silhouette.clone().filter(|_| !excluded(i));
            View::of_silhouette(i as u16, models[i].pinhole(), silhouette)
        };
        (0..models.len()).map(of).collect()
    }

    /// The visual hull as the cameras now stand. Silhouettes that contradict the others do not carve it, nor do those of
    /// cameras that are `excluded`.
    ///
    /// # Errors
    /// Those of [`VisualHull::new`].
    pub(super) fn hull(
        &self,
        models: &[Model],
        excluded: impl Fn(usize) -> bool,
        params: &GuideParams,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Guide> {
        let mut carved = Carved {
            views: self.views(models, &excluded),
            mesh: Mesh::default(),
            footprint: 0.0,
            params: params.hull,
            workspace: Workspace::default(),
        };
        let agreement = params.agreement.as_ref();
        let rounds = if agreement.is_some() { ROUNDS } else { 0 };
        carve_agreeing(&mut carved, agreement, rounds, executor, progress)?;
        // The silhouettes of excluded cameras carve nothing, but what they lack is judged like that of the others.
        let is_set_aside: Vec<bool> = carved.views.iter().map(View::is_set_aside).collect();
        for (i, view) in carved.views.iter_mut().enumerate().filter(|&(i, _)| excluded(i)) {
            view.given.clone_from(&self.pictures[i].silhouette);
        }
        let apart = agreement.map(|params| apart(&carved.views, &carved.mesh, params, executor)).unwrap_or_default();
        let lacking = |place: &u16| {
            agreement.is_some() && carved.views[usize::from(*place)].is_set_aside() && !apart.contains(place)
        };
        let lacking = (0..models.len() as u16).filter(lacking).collect();
        let apart = apart.into_iter().filter(|&place| is_set_aside[usize::from(place)]).collect();
        Ok(Guide { mesh: carved.mesh, footprint: carved.footprint, views: carved.views, apart, lacking })
    }
}

/// A hull that is carved from the views that agree.
struct Carved {
    views: Vec<View>,
    mesh: Mesh,
    footprint: f32,
    params: HullParams,
    workspace: Workspace,
}

impl Carving for Carved {
    fn carve(&mut self, executor: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        let workspace = &mut self.workspace;
        let hull = VisualHull::with_workspace(&self.views, &self.params, None, workspace, executor, progress)?;
        self.mesh = hull.mesh(workspace, executor);
        drop_small_components(&mut self.mesh, SMALLEST_PART, &mut self.workspace);
        self.footprint = hull.footprint();
        Ok(())
    }

    fn parts(&mut self) -> (&mut [View], &mut Mesh, &mut Workspace) {
        (&mut self.views, &mut self.mesh, &mut self.workspace)
    }
}

/// The visual hull of one frame.
pub(super) struct Guide {
    pub(super) mesh: Mesh,
    pub(super) footprint: f32,
    /// The views without pictures. Those that contradict the others are set aside.
    pub(super) views: Vec<View>,
    /// Places of the cameras whose silhouettes show what the hull of the others does not have, and lack what it has.
    pub(super) apart: Vec<u16>,
    /// Places of the cameras whose silhouettes only lack what the hull of the others has.
    pub(super) lacking: Vec<u16>,
}

/// How the hull is carved.
#[derive(Debug, Clone, Copy)]
pub(super) struct GuideParams {
    pub(super) hull: HullParams,
    pub(super) agreement: Option<AgreementParams>,
}
