//! The coarse pass: detection (§4) and meshing (§6) at a lower resolution. Its mesh guides the detection that follows.
//!
//! The paper has no coarse pass: it searches the whole hull at full resolution.

use crate::{
    context::Context,
    detect::{DetectionParams, DetectionScratch, Guide, PyramidLevel, detect_view},
    error::Result,
    executor::Executor,
    mesh::{self, MeshingParams, weigh},
    point_cloud::{Mesh, Point, PointCloud, concat},
    progress::Part,
    silhouette::Silhouette,
    stage::Stage,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use core::iter::once;

/// Parameters of the coarse pass.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CoarseParams {
    /// Detection in this pass.
    pub detection: DetectionParams,
    /// Spacing of the meshing grid's nodes, in pixels of footprint.
    pub voxel_pixels: f32,
}

/// The search of the whole hull begins at the highest octave at which the object still covers this many pixels of the median
/// picture. A window there shows as much of the object as a window of a smaller picture does.
const SEARCHED: usize = 60_000;
/// Search range around a surface that was itself found around another one, relative to [`DetectionParams::band_pixels`].
const NARROW: f32 = 0.5;

/// Number of octaves by which the coarse pass begins above that of its parameters, because the pictures are large.
pub(crate) fn further_octaves(views: &[View]) -> u32 {
    let inside = |view: &View| {
        let silhouette = view.shown().filter(|_| view.is_used())?;
        Some(silhouette.distances().iter().filter(|&&d| d > 0 && d != Silhouette::UNKNOWN).count())
    };
    octaves_of(views.iter().filter_map(inside).collect())
}

/// The number of octaves for the numbers of the object's pixels in the pictures.
fn octaves_of(mut areas: Vec<usize>) -> u32 {
    areas.sort_unstable();
    let mut area = areas.get(areas.len() / 2).copied().unwrap_or(0);
    let mut octaves = 0;
    while area / 4 >= SEARCHED {
        area /= 4;
        octaves += 1;
    }
    octaves
}

/// The search range around the surface that the coarse pass has found, in pixels of footprint.
pub(crate) fn band(detection: &DetectionParams, further: u32) -> f32 {
    detection.band_pixels * if further > 0 { NARROW } else { 1.0 }
}

/// Runs the coarse pass and returns its mesh.
///
/// In large pictures the pass begins `further` octaves above that of its parameters. Each octave below is searched around the
/// surface of the one before, by the parameters `detection` of the search that follows the pass.
///
/// `hull_mesh` is the hull's own mesh and `frontier` the weighted frontier points. `scratch` holds one buffer per job
/// that runs at the same time; the executor adds more if there are too few.
///
/// # Errors
/// [`crate::Error::NoSurface`] and [`crate::Error::Cancelled`].
pub fn coarse(
    context: Context,
    hull_mesh: &Mesh,
    frontier: &[Point],
    (params, detection, meshing): (&CoarseParams, &DetectionParams, &MeshingParams),
    further: u32,
    executor: &dyn Executor,
    scratch: &mut Vec<DetectionScratch>,
    workspace: &mut Workspace,
) -> Result<Mesh> {
    let Context { hull, progress, .. } = context;
    let parts = 2 * (further + 1);
    let mut found: Option<Mesh> = None;
    for octave in (0..=further).rev() {
        let scale = (1u32 << octave) as f32;
        let octave = params.detection.octave + octave;
        let (guide, detection) = match &found {
            None => (Guide::Hull(hull_mesh), DetectionParams { octave, ..params.detection }),
            Some(surface) => {
                let before = params.detection.octave + further - octave - 1;
                let band_pixels = band(detection, before) * (1u32 << octave) as f32;
                (Guide::Surface(surface), DetectionParams { octave, band_pixels, ..*detection })
            }
        };
        let part = parts - 2 * (octave - params.detection.octave + 1);
        let detecting = Part { of: progress, stage: Stage::Coarse, part, parts };
        let inner = context.reporting_to(&detecting);
        let cloud = points(inner, guide, &detection, meshing, frontier, executor, scratch, workspace)?;
        let voxel = scale * params.voxel_pixels * hull.footprint();
        let meshing_part = Part { part: part + 1, ..detecting };
        let mesh = mesh::mesh(&cloud, hull, voxel, meshing, workspace, executor, &meshing_part)?.mesh;
        workspace.recycle(cloud);
        if let Some(old) = found.replace(mesh) {
            old.recycle_into(workspace);
        }
    }
    Ok(found.unwrap_or_default())
}

/// The points of all views around a guide, and the frontier points.
fn points(
    context: Context,
    guide: Guide,
    detection: &DetectionParams,
    meshing: &MeshingParams,
    frontier: &[Point],
    executor: &dyn Executor,
    scratch: &mut Vec<DetectionScratch>,
    workspace: &mut Workspace,
) -> Result<PointCloud> {
    let views = context.views;
    let made = executor
        .map(views.len(), |i| if views[i].is_used() { PyramidLevel::made(&views[i], detection.octave) } else { None });
    let level = |i: usize| PyramidLevel::new(&views[i], made[i].as_ref());
    let found = executor
        .map_with(scratch, views.len(), |scratch, i| detect_view(context, i, &level, guide, detection, scratch));
    let mut clouds = found.into_iter().map(|found| found.map(|(cloud, _)| cloud)).collect::<Result<Vec<_>>>()?;
    clouds.iter_mut().for_each(|cloud| weigh(cloud, meshing.weights.as_ref()));
    Ok(concat(once(frontier).chain(clouds.iter().map(|cloud| &cloud[..])), workspace))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Params, params::Preset};

    #[test]
    fn larger_objects_are_searched_from_higher_octaves() {
        let of = |inside: [usize; 3]| octaves_of(inside.to_vec());
        // The median decides, because the object may leave single pictures or be near to single cameras.
        assert_eq!(of([0, 4 * SEARCHED - 1, 64 * SEARCHED]), 0);
        assert_eq!(of([0, 4 * SEARCHED, 64 * SEARCHED]), 1);
        assert_eq!(of([0, 16 * SEARCHED, 64 * SEARCHED]), 2);
        assert_eq!(octaves_of(Vec::new()), 0);
        let detection = Params::preset(Preset::Default).detection;
        assert_eq!(band(&detection, 0), detection.band_pixels);
        assert!(band(&detection, 1) < detection.band_pixels);
    }
}
