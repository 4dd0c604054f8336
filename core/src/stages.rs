//! The stages between the hull and the mesh (§4 to §6), each a function of borrowed inputs: a host may run one by one,
//! and those of single views on threads of its own, and gets what [`crate::reconstruct`] gives.

use crate::{
    camera::Pinhole,
    detect::{self, Guide, Level, Scratch},
    error::Result,
    hash::Hash64,
    hull::VisualHull,
    merge,
    mesh::{self, Meshed},
    params::Params,
    point_cloud::{self, Mesh, Point, PointCloud},
    progress::{self, Executor, Part, Progress, Stage},
    report::Counts,
    rig::Rig,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use core::iter::once;

/// What the stages pass on.
#[derive(Debug, Clone, Default)]
pub struct Stages {
    /// The visual hull's own mesh.
    pub hull: Mesh,
    /// The mesh of the coarse pass, empty where there is none.
    pub coarse: Mesh,
    /// One cleaned cloud a view (§4).
    pub detected: Vec<PointCloud>,
    /// Frontier points (§4.4).
    pub frontier: PointCloud,
    /// Implicit points (§4.4).
    pub implicit: PointCloud,
    /// The merged cloud (§5).
    pub merged: PointCloud,
}

impl Stages {
    /// Hands back the memory that came from a workspace.
    pub fn keep_in(self, workspace: &mut Workspace) {
        self.hull.keep_in(workspace);
        self.coarse.keep_in(workspace);
        workspace.keep(self.merged);
    }

    /// A 64-bit hash of each stage's output, in the order of [`Stage::ALL`]; `mesh` is the final one.
    pub fn hashes(&self, views: &[View], mesh: &Mesh) -> [u64; Stage::ALL.len()] {
        [
            views.iter().fold(Hash64::default(), |h, v| v.hash(h)).finish(),
            self.hull.hash(),
            point_cloud::hash(self.frontier.iter().chain(&self.implicit)),
            self.coarse.hash(),
            point_cloud::hash(self.detected.iter().flatten()),
            point_cloud::hash(&self.merged),
            mesh.uncoloured_hash(),
            mesh.hash(),
        ]
    }
}

/// The hull's own mesh without stray components, and how many those were (§0).
pub fn hull_mesh(hull: &VisualHull, params: &Params, workspace: &mut Workspace) -> (Mesh, u32) {
    let mut mesh = hull.mesh(workspace);
    let dropped = mesh::drop_small_components(&mut mesh, params.meshing.smallest_component, workspace);
    (mesh, dropped)
}

/// Frontier points of one view (§4.4), weighted for meshing; none if `params` does without.
pub fn frontier(view: &View, hull: &VisualHull, params: &Params) -> PointCloud {
    let Some(p) = &params.frontier else { return PointCloud::new() };
    let mut cloud = detect::frontier(view, hull, p);
    cloud.iter_mut().for_each(|point| point.weight *= params.merging.frontier_weight);
    cloud
}

/// Implicit points (§4.4), weighted for meshing; none if `params` does without. They are the second half of their stage.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn implicit(hull_mesh: &Mesh, views: &[View], params: &Params, progress: &dyn Progress) -> Result<PointCloud> {
    if !params.implicit {
        return Ok(PointCloud::new());
    }
    let count = views.len() as u32;
    let tick = |i| progress::step(progress, Stage::Contours, count + i, 2 * count);
    let mut cloud = detect::implicit(hull_mesh, views, tick)?;
    cloud.iter_mut().for_each(|point| point.weight = params.merging.implicit_weight);
    Ok(cloud)
}

/// The mesh of the coarse pass, which guides the second; empty if `params` does without. Of the memory to use the first are
/// buffers of views; more are added where more pieces run at a time.
///
/// # Errors
/// [`crate::Error::NoSurface`] and [`crate::Error::Cancelled`].
pub fn coarse(
    rig: &Rig,
    views: &[View],
    hull_mesh: &Mesh,
    frontier: &[Point],
    hull: &VisualHull,
    params: &Params,
    executor: &impl Executor,
    (scratch, workspace): (&mut Vec<Scratch>, &mut Workspace),
    progress: &dyn Progress,
) -> Result<Mesh> {
    let Some(p) = &params.coarse else { return Ok(Mesh::default()) };
    let levels = executor.map(views.len(), |i| Level::new(&views[i], p.detection.halved));
    let detecting = Part { of: progress, stage: Stage::Coarse, part: 0, parts: 2 };
    let meshing = Part { part: 1, ..detecting };
    let guide = Guide::Hull(hull_mesh);
    let detect =
        |scratch: &mut Scratch, i| detect::detect(rig, i, &levels, hull, guide, &p.detection, scratch, &detecting);
    let found = executor.map_with(scratch, levels.len(), detect);
    let found: Vec<_> = found.into_iter().collect::<Result<_>>()?;
    let clouds: Vec<_> = once(frontier).chain(found.iter().map(|(cloud, _)| &cloud[..])).collect();
    let cloud = concat(&clouds, workspace);
    let voxel = p.voxel_pixels * hull.footprint();
    let mesh = mesh::mesh(&cloud, hull, voxel, &params.meshing, workspace, &meshing)?.mesh;
    workspace.keep(cloud);
    Ok(mesh)
}

/// All views at the resolution at which `params` detects.
pub fn levels<'a>(views: &'a [View], params: &Params, executor: &impl Executor) -> Vec<Level<'a>> {
    executor.map(views.len(), |i| Level::new(&views[i], params.detection.halved))
}

/// The cleaned points of one view (§4.1 to §4.3) and what was counted. `levels` are all views
/// at the resolution of `params.detection` ([`levels`]), `hull_mesh` and `coarse` the results of [`hull_mesh`] and [`coarse`].
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn detect(
    rig: &Rig,
    view: usize,
    levels: &[Level],
    hull: &VisualHull,
    hull_mesh: &Mesh,
    coarse: &Mesh,
    params: &Params,
    scratch: &mut Scratch,
    progress: &dyn Progress,
) -> Result<(PointCloud, Counts)> {
    let guide = if params.coarse.is_some() { Guide::Surface(coarse) } else { Guide::Hull(hull_mesh) };
    detect::detect(rig, view, levels, hull, guide, &params.detection, scratch, progress)
}

/// The points of all stages so far as one cloud (§5).
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn merge(
    stages: &Stages,
    views: &[View],
    hull: &VisualHull,
    params: &Params,
    counts: &mut Counts,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<PointCloud> {
    let cameras: Vec<Pinhole> = views.iter().map(|v| v.camera).collect();
    let Stages { frontier, detected, implicit, .. } = stages;
    let clouds: Vec<_> = once(frontier).chain(detected).chain(once(implicit)).map(|cloud| &cloud[..]).collect();
    let all = concat(&clouds, workspace);
    let neighbours = params.detection.search.neighbours;
    merge::merge(all, hull, &cameras, neighbours, &params.merging, counts, progress)
}

/// The mesh of the merged cloud (§6), without colours.
///
/// # Errors
/// [`crate::Error::NoSurface`] and [`crate::Error::Cancelled`].
pub fn mesh(
    merged: &[Point],
    hull: &VisualHull,
    params: &Params,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<Meshed> {
    let voxel = params.meshing.voxel_pixels * hull.footprint();
    mesh::mesh(merged, hull, voxel, &params.meshing, workspace, progress)
}

fn concat(clouds: &[&[Point]], workspace: &mut Workspace) -> PointCloud {
    let mut all = workspace.empty(clouds.iter().map(|cloud| cloud.len()).sum());
    clouds.iter().for_each(|cloud| all.extend_from_slice(cloud));
    all
}
