//! PCMVS: multi-view stereo for free-viewpoint video.
#![no_std]

extern crate alloc;

pub mod camera;
pub mod coarse;
pub mod colour;
mod context;
pub mod contours;
pub mod detect;
mod eigen;
pub mod error;
mod executor;
pub mod export;
pub mod frame;
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
mod progress;
pub mod raster;
mod report;
pub mod rig;
pub mod silhouette;
mod simd;
mod stage;
pub mod surface;
mod undistort;
pub mod view;
pub mod workspace;

pub use camera::{Camera, Pinhole};
pub use context::Context;
pub use error::{Error, ErrorCode, Result};
pub use executor::{Executor, Pool, Serial};
pub use frame::{Frame, Memory, Reconstruction};
pub use glam;
pub use image::{ImageRef, PixelFormat};
pub use params::{Params, Preset};
pub use point_cloud::{Mesh, Point, PointCloud, Rank};
pub use progress::{Progress, Silent};
pub use report::Counts;
pub use rig::Rig;
pub use silhouette::ChromaKey;
pub use stage::Stage;
pub use view::{Mask, View, ViewInput};
pub use workspace::Workspace;

/// Reconstructs one frame from one input per camera, in the order in which the cameras were given to [`Rig::new`].
///
/// # Errors
/// Every [`Error`] but [`Error::WrongOrder`]. Nothing is kept of a frame that fails.
pub fn reconstruct(
    rig: &Rig,
    inputs: &[ViewInput],
    params: &Params,
    executor: &impl Executor,
    progress: &dyn Progress,
) -> Result<Reconstruction> {
    let mut frame = Frame::new(rig, *params, Memory::default());
    frame.run_all(inputs, executor, progress)?;
    Ok(frame.into_reconstruction())
}

/// The README's example compiles.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
