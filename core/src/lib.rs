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
pub mod memory;
pub mod merge;
pub mod mesh;
pub mod params;
pub mod point_cloud;
pub mod progress;
pub mod raster;
pub mod report;
pub mod rig;
pub mod silhouette;
mod simd;
pub mod stages;
mod undistort;
pub mod view;
pub mod workspace;

use alloc::vec::Vec;
use hull::VisualHull;
use params::Method;

pub use camera::{Camera, Pinhole};
pub use error::{Error, Result};
pub use image::{ImageRef, PixelFormat};
pub use params::{Params, Preset};
pub use point_cloud::{Mesh, Point, PointCloud, Rank};
pub use progress::{Executor, Progress, Serial, Silent, Stage};
pub use report::Counts;
pub use rig::Rig;
pub use silhouette::ChromaKey;
pub use stages::Stages;
pub use view::{Mask, View, ViewInput};
pub use workspace::Workspace;

/// A frame's result.
#[derive(Debug, Clone)]
pub struct Reconstruction {
    /// The closed, coloured mesh.
    pub mesh: Mesh,
    /// What each camera's red, green and blue were multiplied by for the mesh's colours, in the order of the cameras as
    /// given. [`Rig::with_gains`] fixes them for later frames.
    pub gains: Vec<[f32; 3]>,
    /// What was counted.
    pub counts: Counts,
    /// A 64-bit hash of each stage's output, in the order of [`Stage::ALL`].
    pub hashes: [u64; Stage::ALL.len()],
    /// What the stages passed on.
    pub stages: Stages,
}

/// Reconstructs one frame from one input a camera, in the order in which the cameras were given to [`Rig::new`].
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
    if inputs.len() != rig.cameras().len() {
        return Err(Error::ViewCount { given: inputs.len() as u32, cameras: rig.cameras().len() as u32 });
    }
    memory::check_least(rig, params)?;
    let mut counts = Counts::default();
    let workspace = &mut Workspace::default();
    let views = timed(progress, Stage::Views, || views(rig, inputs, executor, progress))?;

    // §0: the hull, and its own mesh.
    let hull = timed(progress, Stage::Hull, || VisualHull::in_memory(&views, &params.hull, workspace, progress))?;
    memory::check_hull(&views, &hull, params)?;
    let mut stages = Stages::default();
    (stages.hull, counts.components_dropped) = stages::hull_mesh(&hull, params, workspace);
    memory::check(&views, &hull, &stages.hull, params)?;
    let mut mesh = if params.method == Method::Hull {
        stages.hull.clone()
    } else {
        pcmvs(rig, &views, &hull, params, &mut stages, &mut counts, executor, workspace, progress)?
    };

    // §7.
    let gains = timed(progress, Stage::Colour, || {
        colour::colour(&mut mesh, &views, rig.gains(), &params.colour, workspace, progress)
    })?;
    (counts.vertices, counts.faces) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
    let hashes = stages.hashes(&views, &mesh);
    Ok(Reconstruction { mesh, gains: rig.as_given(&gains), counts, hashes, stages })
}

/// §4 to §6: from the hull to the mesh.
fn pcmvs(
    rig: &Rig,
    views: &[View],
    hull: &VisualHull,
    params: &Params,
    stages: &mut Stages,
    counts: &mut Counts,
    executor: &impl Executor,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<Mesh> {
    // §4.4: points that the silhouettes alone give.
    timed(progress, Stage::Contours, || {
        let found = executor.map(views.len(), |i| {
            progress::step(progress, Stage::Contours, i as u32, 2 * views.len() as u32)?;
            Ok(stages::frontier(&views[i], hull, params))
        });
        for cloud in found {
            stages.frontier.extend(cloud?);
        }
        stages.implicit = stages::implicit(&stages.hull, views, params, progress)?;
        Ok(())
    })?;
    (counts.frontier, counts.implicit) = (stages.frontier.len() as u32, stages.implicit.len() as u32);

    // §4.1 to §4.3, coarse to fine.
    let mut scratch: Vec<detect::Scratch> = Vec::new();
    if params.coarse.is_some() {
        stages.coarse = timed(progress, Stage::Coarse, || {
            let memory = (&mut scratch, &mut *workspace);
            stages::coarse(rig, views, &stages.hull, &stages.frontier, hull, params, executor, memory, progress)
        })?;
    }
    timed(progress, Stage::Detect, || {
        let levels = stages::levels(views, params, executor);
        let detect = |scratch: &mut detect::Scratch, i| {
            stages::detect(rig, i, &levels, hull, &stages.hull, &stages.coarse, params, scratch, progress)
        };
        for found in executor.map_with(&mut scratch, views.len(), detect) {
            let (cloud, found) = found?;
            stages.detected.push(cloud);
            counts.add_detection(&found);
        }
        Ok(())
    })?;
    drop(scratch);

    // §5.
    stages.merged =
        timed(progress, Stage::Merge, || stages::merge(stages, views, hull, params, counts, workspace, progress))?;

    // §6.
    let meshed = timed(progress, Stage::Mesh, || stages::mesh(&stages.merged, hull, params, workspace, progress))?;
    counts.components_dropped = meshed.components_dropped;
    Ok(meshed.mesh)
}

fn views(rig: &Rig, inputs: &[ViewInput], executor: &impl Executor, progress: &dyn Progress) -> Result<Vec<View>> {
    let views = executor.map_with(&mut Vec::new(), inputs.len(), |scratch, i| {
        progress::step(progress, Stage::Views, i as u32, inputs.len() as u32)?;
        let given = rig.order()[i] as usize;
        View::in_memory(rig, given, &inputs[given], scratch, view::Buffers::default())
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
