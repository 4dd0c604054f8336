//! The coarse pass: detection (§4) and meshing (§6) at a lower resolution. Its mesh guides the detection that follows.
//!
//! The paper has no coarse pass: it searches the whole hull at full resolution.

use crate::{
    context::Context,
    detect::{DetectionParams, DetectionScratch, Guide, PyramidLevel, detect_view},
    error::Result,
    executor::Executor,
    mesh::{self, MeshingParams, weigh},
    point_cloud::{Mesh, Point, concat},
    progress::Part,
    stage::Stage,
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

/// Runs the coarse pass and returns its mesh.
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
    (params, meshing): (&CoarseParams, &MeshingParams),
    executor: &impl Executor,
    scratch: &mut Vec<DetectionScratch>,
    workspace: &mut Workspace,
) -> Result<Mesh> {
    let Context { views, hull, progress, .. } = context;
    let octave = params.detection.octave;
    let made =
        executor.map(views.len(), |i| if views[i].is_used() { PyramidLevel::made(&views[i], octave) } else { None });
    let level = |i: usize| PyramidLevel::new(&views[i], made[i].as_ref());
    let detecting = Part { of: progress, stage: Stage::Coarse, part: 0, parts: 2 };
    let inner = context.reporting_to(&detecting);
    let guide = Guide::Hull(hull_mesh);
    let found = executor
        .map_with(scratch, views.len(), |scratch, i| detect_view(inner, i, &level, guide, &params.detection, scratch));
    let mut clouds = found.into_iter().map(|found| found.map(|(cloud, _)| cloud)).collect::<Result<Vec<_>>>()?;
    clouds.iter_mut().for_each(|cloud| weigh(cloud, meshing.weights.as_ref()));
    let cloud = concat(once(frontier).chain(clouds.iter().map(|cloud| &cloud[..])), workspace);
    let voxel = params.voxel_pixels * hull.footprint();
    let mesh = mesh::mesh(&cloud, hull, voxel, meshing, workspace, executor, &Part { part: 1, ..detecting })?.mesh;
    workspace.recycle(cloud);
    Ok(mesh)
}
