//! PCMVS: multi-view stereo for free-viewpoint video.
#![no_std]

extern crate alloc;

pub mod camera;
pub mod colour;
pub mod error;
pub mod grid;
pub mod hash;
pub mod image;
pub mod params;
pub mod point_cloud;
pub mod progress;
pub mod report;
pub mod rig;
pub mod silhouette;
mod undistort;
pub mod view;

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
    /// One cleaned cloud a view (§4).
    pub detected: alloc::vec::Vec<PointCloud>,
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
    let views = executor.map(inputs.len(), |i| {
        let view = View::new(rig, i, &inputs[i])?;
        progress::step(progress, Stage::Views, i as u32 + 1, inputs.len() as u32)?;
        Ok(view)
    });
    let _views = views.into_iter().collect::<Result<alloc::vec::Vec<View>>>()?;
    let _ = params;
    Err(Error::EmptyHull)
}
