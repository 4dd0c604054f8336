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
    error::{Error, Result},
    executor::Executor,
    hull::{AgreementParams, HullParams, VisualHull, contradicting, uncovered_share},
    point_cloud::Mesh,
    progress::Progress,
    rig::MIN_VIEWS,
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
/// Largest number of times that the hull is carved again without silhouettes that contradict it.
const ROUNDS: usize = 2;

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
            // The silhouette as it was given: one that contradicts the others may be that of a camera that was bumped.
            let silhouette = view.given.clone().or_else(|| view.silhouette.clone());
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
        progress: &dyn Progress,
    ) -> Result<Guide> {
        let mut workspace = Workspace::default();
        let mut views: Vec<View> = (0..models.len())
            .map(|i| View {
                index: i as u16,
                camera: models[i].pinhole(),
                rgb: Vec::new(),
                luma: Vec::new(),
                silhouette: self.pictures[i].silhouette.clone().filter(|_| !excluded(i)),
                given: None,
                added: 0,
                left_out: None,
            })
            .collect();
        let silhouettes = views.iter().filter(|view| view.silhouette.is_some()).count();
        let spare = silhouettes.saturating_sub(MIN_VIEWS as usize);
        let mut carved = carve(&views, &params.hull, &mut workspace, progress);
        let Some(agreement) = params.agreement else {
            return carved.map(|(mesh, footprint)| Guide { mesh, footprint, apart: Vec::new() });
        };
        let most = ((agreement.largest_share * silhouettes as f32) as usize).min(spare);
        let mut set_aside = Vec::new();
        for _ in 0..ROUNDS {
            let empty = Mesh::default();
            let mesh = match &carved {
                Ok((mesh, _)) => mesh,
                Err(Error::EmptyHull) => &empty,
                Err(error) => return Err(error.clone()),
            };
            let room = most.saturating_sub(set_aside.len());
            let guilty = contradicting(&views, mesh, agreement.blame, room, &mut workspace, progress)?;
            if guilty.is_empty() {
                break;
            }
            guilty.iter().for_each(|&place| views[usize::from(place)].silhouette = None);
            set_aside.extend(guilty);
            carved = carve(&views, &params.hull, &mut workspace, progress);
        }
        let (mesh, footprint) = carved?;
        let is_apart = |&place: &u16| {
            let silhouette = self.pictures[usize::from(place)].silhouette.as_deref();
            let share = silhouette.map(|s| uncovered_share(&views[usize::from(place)].camera, s, &mesh));
            share.is_some_and(|share| share > agreement.uncovered)
        };
        set_aside.retain(is_apart);
        Ok(Guide { mesh, footprint, apart: set_aside })
    }
}

/// The visual hull of one frame.
pub(super) struct Guide {
    pub(super) mesh: Mesh,
    pub(super) footprint: f32,
    /// Places of the cameras whose silhouettes show what the hull of the others does not have, and lack what it has.
    pub(super) apart: Vec<u16>,
}

/// How the hull is carved.
#[derive(Debug, Clone, Copy)]
pub(super) struct GuideParams {
    pub(super) hull: HullParams,
    pub(super) agreement: Option<AgreementParams>,
}

/// The mesh of the hull of some views, and its footprint.
fn carve(
    views: &[View],
    params: &HullParams,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<(Mesh, f32)> {
    let hull = VisualHull::with_workspace(views, params, None, workspace, progress)?;
    let mut mesh = hull.mesh(workspace);
    drop_small_components(&mut mesh, SMALLEST_PART, workspace);
    Ok((mesh, hull.footprint()))
}
