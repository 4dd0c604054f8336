//! PCMVS: multi-view stereo for free-viewpoint video.
//!
//! From calibrated, synchronised photographs and silhouettes of a subject, the crate reconstructs one closed, coloured
//! triangle mesh per frame. It implements Liu, Dai and Xu, "A Point-Cloud-Based Multiview Stereo Algorithm for
//! Free-Viewpoint Video" (IEEE TVCG 16(3), 2010), with improvements that were measured ([`Preset::Default`]). The paper's
//! own method is kept as [`Preset::Paper`]. Numbers with § in this documentation are sections of the paper.
//!
//! # Example
//!
//! ```
//! use pcmvs_core::{
//!     Camera, ImageRef, Mask, Params, PixelFormat, Preset, Result, Rig, Serial, Silent, ViewInput, export::glb, reconstruct,
//! };
//!
//! /// Reconstructs one frame and returns it as a GLB file. There is one packed RGB photograph and one 8-bit mask, which is
//! /// white on the subject, per camera.
//! fn frame_to_glb(cameras: &[Camera], photographs: &[Vec<u8>], masks: &[Vec<u8>]) -> Result<Vec<u8>> {
//!     // The rig is shared by all frames.
//!     let rig = Rig::new(cameras)?;
//!     let mut inputs = Vec::new();
//!     for (i, camera) in cameras.iter().enumerate() {
//!         let (width, height) = (camera.width, camera.height);
//!         let image = ImageRef::packed(&photographs[i], width, height, PixelFormat::Rgb8);
//!         let mask = ImageRef::packed(&masks[i], width, height, PixelFormat::Gray8);
//!         inputs.push(ViewInput { image, mask: Mask::Given(mask) });
//!     }
//!     let params = Params::preset(Preset::Default);
//!     let result = reconstruct(&rig, &inputs, &params, &Serial, &Silent)?;
//!     Ok(glb::write(&result.mesh, rig.origin(), &glb::Options::default()))
//! }
//! ```
//!
//! `examples/reconstruct.rs` is a complete program. Without masks, use [`Mask::ChromaKey`] or [`Mask::CleanPlate`].
//!
//! # Coordinates and units
//!
//! - **Scene**: the world frame of the calibration. The host chooses its axes and its unit of length.
//! - **Camera**: x right, y down, z forward. A world point X projects to `x = K · distort(R X + t)` ([`Camera`]).
//! - **Picture**: x right, y down. The centre of the first pixel is at (0, 0).
//! - **Internal**: single precision, with the scene's axes and unit, relative to [`Rig::origin`]. Positions of [`Mesh`] and
//!   [`Point`] are in this frame; [`export`] adds the origin.
//!
//! Depth is measured along the optical axis. Parameters give lengths in pixels of footprint, the size of a pixel at the
//! subject, so that they do not depend on the scene's unit. Colours of pictures and meshes are sRGB.
//!
//! # Stage by stage
//!
//! [`reconstruct`] is a short form of [`Frame::run_all`]. A host that schedules the work itself, or needs intermediate
//! results, runs the stages of a [`Frame`] one by one:
//!
//! ```
//! use pcmvs_core::{Frame, Memory, Mesh, Params, Preset, Result, Rig, Serial, Silent, ViewInput, frame::ORDER};
//!
//! fn run(rig: &Rig, inputs: &[ViewInput], memory: Memory) -> Result<(Mesh, Memory)> {
//!     let mut frame = Frame::new(rig, Params::preset(Preset::Default), memory);
//!     for (camera, input) in inputs.iter().enumerate() {
//!         frame.view(camera, input, &Silent)?;
//!     }
//!     for stage in ORDER {
//!         frame.step(stage, &Serial, &Silent)?;
//!     }
//!     let mesh = frame.mesh().clone();
//!     // The working memory can be used for the next frame.
//!     Ok((mesh, frame.recycle()))
//! }
//! ```
//!
//! [`Frame::view`] and [`Frame::detect`] take `&self` and can run on several threads. Alternatively, implement
//! [`Executor`] to run the jobs of all stages on your own threads. [`Progress`] reports progress and cancels.
//!
//! | Stage | Module | Paper |
//! |---|---|---|
//! | [`Stage::Views`] | [`view`], [`silhouette`] | §0: silhouettes |
//! | [`Stage::Hull`] | [`hull`] | §0: visual hull |
//! | [`Stage::Contours`] | [`contours`] | §4.4: frontier and implicit points |
//! | [`Stage::Coarse`] | [`mod@coarse`] | not in the paper |
//! | [`Stage::Detect`] | [`detect`] | §4.1 to §4.3: point cloud detection |
//! | [`Stage::Merge`] | [`mod@merge`] | §5: downsampling and conflict cleaning |
//! | [`Stage::Mesh`] | [`mod@mesh`], [`surface`] | §6: weights, Poisson reconstruction, space constraint |
//! | [`Stage::Colour`] | [`mod@colour`] | §7: colours |
//!
//! # Guarantees
//!
//! - **Determinism**: the same inputs give the same bits on every platform, with any executor and for any numbering of
//!   the cameras. [`Frame::hashes`] has one hash per stage to verify this.
//! - **Meshes** are closed and manifold, and triangles are counter-clockwise as seen from outside.
//! - **Frames** are independent of each other, unless the host sets a [`frame::Prior`], averages them ([`Frame::steady`]), or
//!   reads their views together ([`Frame::read_views_between`]).
//! - **Invalid input** gives an [`Error`] that names the camera and the remedy.
//! - **Memory** can be limited ([`Memory::limited`]). A frame that needs more is refused before it allocates it.
//! - The crate is `no_std` and needs only `alloc`. It does not access files, clocks or threads.
//!
//! # Features
//!
//! - `serde`: `Serialize` and `Deserialize` for [`Params`], and `Serialize` for [`Counts`] and [`Stage`].
#![no_std]

extern crate alloc;

pub mod calibration;
pub mod camera;
mod chessboard;
pub mod coarse;
pub mod colour;
mod colour_counts;
mod context;
pub mod contours;
mod cut_out;
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
mod left_out;
mod lens;
mod linear;
pub mod lost_part;
mod math;
pub mod memory;
pub mod merge;
pub mod mesh;
mod neighbour_grid;
pub mod params;
pub mod point_cloud;
mod progress;
pub mod raster;
pub mod reading;
mod report;
pub mod rig;
pub mod silhouette;
mod simd;
pub mod simplify;
mod sort;
mod stage;
pub mod steady;
pub mod surface;
#[cfg(test)]
mod testing;
pub mod texture;
mod undistort;
pub mod view;
mod window;
pub mod workspace;

pub use camera::{Camera, Pinhole};
pub use context::Context;
pub use error::{Error, ErrorCode, Result};
pub use executor::{Executor, Pool, Serial};
pub use frame::{Form, FormParams, Frame, Memory, Reconstruction, ViewDiagnostics, Warning};
pub use glam;
pub use image::{ImageRef, PixelFormat};
pub use left_out::LeftOut;
pub use lens::Lens;
pub use params::{Params, Preset};
pub use point_cloud::{Mesh, Point, PointCloud, Rank};
pub use progress::{Progress, Silent};
pub use report::Counts;
pub use rig::Rig;
pub use silhouette::ChromaKey;
pub use stage::Stage;
pub use texture::{Texture, TextureParams};
pub use view::{Mask, View, ViewInput};
pub use workspace::Workspace;

/// Reconstructs one frame. There is one input per camera, in the order in which the cameras were passed to [`Rig::new`]:
/// a [`ViewInput`], or an `Option` of one that is `None` where a camera has no picture.
///
/// # Errors
/// Any [`Error`] except [`Error::WrongOrder`].
pub fn reconstruct<'i>(
    rig: &Rig,
    inputs: &[impl Into<Option<ViewInput<'i>>> + Copy + Sync],
    params: &Params,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Reconstruction> {
    let mut frame = Frame::new(rig, *params, Memory::default());
    frame.keep_views(false);
    frame.run_all(inputs, executor, progress)?;
    Ok(frame.into_reconstruction())
}

/// Compiles the README's example.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
