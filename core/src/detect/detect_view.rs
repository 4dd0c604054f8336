//! Detection of one view: depth map (§4.1), substitution where stereo has failed (§4.2) and cleaning (§4.3).

use super::{
    clean::{self, CleanParams, CleanScratch},
    depth::{self, DepthMap, SearchParams, SweepScratch},
    level::PyramidLevel,
    range::SearchRange,
    substitute::{SubstitutionParams, substitute},
};
use crate::{
    context::Context,
    error::Result,
    point_cloud::{Mesh, PointCloud, Rank},
    progress,
    raster::{Crossings, Raster},
    report::Counts,
    stage::Stage,
};
use alloc::vec::Vec;

/// Parameters of point cloud detection (§4).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct DetectionParams {
    /// Level of the image pyramid: 0 is full resolution and 1 half resolution.
    pub octave: u32,
    /// Search along the rays (§4.1).
    pub search: SearchParams,
    /// Half width of the search range around a guide surface, in pixels of footprint along the optical axis.
    pub band_pixels: f32,
    /// Substitution (§4.2). Without it, pixels for which stereo has failed give no point.
    pub substitution: Option<SubstitutionParams>,
    /// Cleaning (§4.3).
    pub clean: CleanParams,
}

/// The surface that guides the search.
#[derive(Clone, Copy)]
pub enum Guide<'a> {
    /// The hull's mesh. The whole hull is searched, as in the paper.
    Hull(&'a Mesh),
    /// A mesh that is close to the result. Only a band around it is searched.
    Surface(&'a Mesh),
    /// A mesh that is close to the result, but may lack thin parts. A band around it is searched, and the whole hull where the
    /// view does not see it.
    Incomplete {
        /// The mesh.
        surface: &'a Mesh,
        /// The hull's mesh.
        hull: &'a Mesh,
    },
}

/// Buffers for the detection of one view after another. Their content never affects a result.
#[derive(Default)]
pub struct DetectionScratch {
    raster: Raster,
    crossings: Crossings,
    range: SearchRange,
    depth: SweepScratch,
    map: DepthMap,
    rank: Vec<Rank>,
    clean: CleanScratch,
}

/// Detects the points of one view (§4.1 to §4.3). Their weights are set later ([`crate::mesh::weigh`]).
///
/// `view` is a place in the rig's order. `level` returns the view at a place in the resolution of `params.octave`.
/// Progress is reported once per row of tiles.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn detect_view<'l>(
    context: Context,
    view: usize,
    level: &dyn Fn(usize) -> PyramidLevel<'l>,
    guide: Guide,
    params: &DetectionParams,
    scratch: &mut DetectionScratch,
) -> Result<(PointCloud, Counts)> {
    if !context.views[view].is_used() {
        return Ok((PointCloud::new(), Counts::default()));
    }
    let Context { rig, views, hull, progress } = context;
    let DetectionScratch { raster, crossings, range, depth, map, rank, clean } = scratch;
    let compared = rig.neighbours(view).iter().map(|&j| j as usize).filter(|&j| views[j].is_used());
    let neighbours: Vec<PyramidLevel> = compared.map(level).collect();
    let neighbours: Vec<&PyramidLevel> = neighbours.iter().collect();
    let level = &level(view);
    match guide {
        Guide::Hull(mesh) => {
            crossings.find(mesh, &level.camera);
            range.set_in_hull(level, crossings);
        }
        Guide::Surface(mesh) => {
            raster.render(mesh, &level.camera);
            range.set_around_surface(level, raster, params.band_pixels * hull.footprint(), None);
        }
        Guide::Incomplete { surface, hull: hull_mesh } => {
            raster.render(surface, &level.camera);
            crossings.find(hull_mesh, &level.camera);
            range.set_around_surface(level, raster, params.band_pixels * hull.footprint(), Some(crossings));
        }
    }
    let tick = |_, _| progress::step(progress, Stage::Detect, view as u32, views.len() as u32);
    depth::depth_map(level, &neighbours, range, &params.search, depth, map, tick)?;

    let mut counts = Counts::default();
    substitute(map, &range.guide, params.substitution.as_ref(), rank, &mut counts);
    let cloud = clean::clean(level, map, rank, view as u16, &params.clean, hull.footprint(), clean, &mut counts);
    Ok((cloud, counts))
}
