//! PCMVS: multi-view stereo for free-viewpoint video.
#![no_std]

extern crate alloc;

pub mod camera;
pub mod colour;
pub mod detect;
mod eigen;
pub mod error;
pub mod export;
pub mod grid;
pub mod hash;
pub mod hull;
pub mod image;
mod math;
pub mod merge;
pub mod mesh;
pub mod params;
pub mod point_cloud;
pub mod progress;
pub mod raster;
pub mod report;
pub mod rig;
pub mod silhouette;
mod undistort;
pub mod view;

use alloc::vec::Vec;
use detect::{Guide, Level, detect, frontier, implicit};
use hash::Hash64;
use hull::VisualHull;
use params::Method;
use progress::Part;

pub use camera::{Camera, Pinhole};
pub use error::{Error, Result};
pub use image::{ImageRef, PixelFormat};
pub use params::{Params, Preset};
pub use point_cloud::{Mesh, Point, PointCloud, Rank};
pub use progress::{Executor, Progress, Serial, Silent, Stage};
pub use report::Counts;
pub use rig::Rig;
pub use silhouette::ChromaKey;
pub use view::{Mask, View, ViewInput};

/// A frame's result.
#[derive(Debug, Clone)]
pub struct Reconstruction {
    /// The closed, coloured mesh.
    pub mesh: Mesh,
    /// What was counted.
    pub counts: Counts,
    /// A 64-bit hash of each stage's output, in the order of [`Stage::ALL`].
    pub hashes: [u64; Stage::ALL.len()],
    /// What the stages passed on.
    pub stages: Stages,
}

/// What the stages passed on, for a look at how a result came about.
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

/// Reconstructs one frame: one input a camera of the rig, in the rig's order.
///
/// # Errors
/// Every [`Error`]; nothing is kept of a frame that fails.
pub fn reconstruct(
    rig: &Rig,
    inputs: &[ViewInput],
    params: &Params,
    executor: &impl Executor,
    progress: &dyn Progress,
) -> Result<Reconstruction> {
    let mut counts = Counts::default();
    let views = timed(progress, Stage::Views, || views(rig, inputs, executor, progress))?;

    // §0: the hull, and its own mesh.
    let hull = timed(progress, Stage::Hull, || VisualHull::new(&views, &params.hull, progress))?;
    let mut hull_mesh = hull.mesh();
    counts.components_dropped = mesh::drop_small_components(&mut hull_mesh, params.meshing.smallest_component);
    let mut stages = Stages { hull: hull_mesh, ..Stages::default() };
    let mut mesh = if params.method == Method::Hull {
        stages.hull.clone()
    } else {
        pcmvs(&views, &hull, params, &mut stages, &mut counts, executor, progress)?
    };

    // §7.
    timed(progress, Stage::Colour, || colour::colour(&mut mesh, &views, &params.colour, progress))?;
    (counts.vertices, counts.faces) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
    let hashes = [
        views.iter().fold(Hash64::default(), |h, v| v.hash(h)).finish(),
        stages.hull.hash(),
        point_cloud::hash(stages.frontier.iter().chain(&stages.implicit)),
        stages.coarse.hash(),
        point_cloud::hash(stages.detected.iter().flatten()),
        point_cloud::hash(&stages.merged),
        Mesh { colours: Vec::new(), ..mesh.clone() }.hash(),
        mesh.hash(),
    ];
    Ok(Reconstruction { mesh, counts, hashes, stages })
}

/// §4 to §6: from the hull to the mesh.
fn pcmvs(
    views: &[View],
    hull: &VisualHull,
    params: &Params,
    stages: &mut Stages,
    counts: &mut Counts,
    executor: &impl Executor,
    progress: &dyn Progress,
) -> Result<Mesh> {
    let full = executor.map(views.len(), |i| Level::full(&views[i]));
    let merging = &params.merging;

    // §4.4: points that the silhouettes alone give.
    timed(progress, Stage::Contours, || {
        if let Some(p) = &params.frontier {
            let found = executor.map(views.len(), |i| {
                progress::step(progress, Stage::Contours, i as u32, views.len() as u32)?;
                Ok(frontier(&views[i], hull, p))
            });
            for cloud in found {
                stages.frontier.extend(cloud?);
            }
            stages.frontier.iter_mut().for_each(|p| p.weight *= merging.frontier_weight);
        }
        if params.implicit {
            stages.implicit = implicit(&stages.hull, views);
            stages.implicit.iter_mut().for_each(|p| p.weight = merging.implicit_weight);
        }
        Ok(())
    })?;
    (counts.frontier, counts.implicit) = (stages.frontier.len() as u32, stages.implicit.len() as u32);

    // §4.1 to §4.3, coarse to fine.
    if let Some(p) = &params.coarse {
        stages.coarse = timed(progress, Stage::Coarse, || {
            let half = executor.map(full.len(), |i| full[i].halved());
            let detecting = Part { of: progress, stage: Stage::Coarse, part: 0, parts: 2 };
            let meshing = Part { part: 1, ..detecting };
            let found = executor
                .map(half.len(), |i| detect(i, &half, hull, Guide::Hull(&stages.hull), &p.detection, &detecting));
            let mut cloud = stages.frontier.clone();
            for found in found {
                cloud.extend(found?.0);
            }
            let voxel = p.voxel_pixels * hull.footprint();
            Ok(mesh::mesh(&cloud, hull, voxel, &params.meshing, &meshing)?.mesh)
        })?;
    }
    let guide = if params.coarse.is_some() { Guide::Surface(&stages.coarse) } else { Guide::Hull(&stages.hull) };
    timed(progress, Stage::Detect, || {
        let found = executor.map(full.len(), |i| detect(i, &full, hull, guide, &params.detection, progress));
        for found in found {
            let (cloud, found) = found?;
            stages.detected.push(cloud);
            counts.add_detection(&found);
        }
        Ok(())
    })?;

    // §5.
    let cameras: Vec<Pinhole> = views.iter().map(|v| v.camera).collect();
    let all = stages.frontier.iter().chain(stages.detected.iter().flatten()).chain(&stages.implicit).copied().collect();
    let neighbours = params.detection.search.neighbours;
    stages.merged =
        timed(progress, Stage::Merge, || merge::merge(all, hull, &cameras, neighbours, merging, counts, progress))?;

    // §6.
    let voxel = params.meshing.voxel_pixels * hull.footprint();
    let meshed = timed(progress, Stage::Mesh, || mesh::mesh(&stages.merged, hull, voxel, &params.meshing, progress))?;
    counts.components_dropped = meshed.components_dropped;
    Ok(meshed.mesh)
}

fn views(rig: &Rig, inputs: &[ViewInput], executor: &impl Executor, progress: &dyn Progress) -> Result<Vec<View>> {
    let views = executor.map(inputs.len(), |i| {
        progress::step(progress, Stage::Views, i as u32, inputs.len() as u32)?;
        let given = rig.order()[i] as usize;
        View::new(rig, given, &inputs[given])
    });
    views.into_iter().collect()
}

/// Tells the host when a stage begins and ends.
fn timed<T>(progress: &dyn Progress, stage: Stage, work: impl FnOnce() -> Result<T>) -> Result<T> {
    progress.mark(stage, true);
    let result = work();
    progress.mark(stage, false);
    result
}

/// The README's example compiles.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
