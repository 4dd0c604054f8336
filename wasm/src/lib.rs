//! pcmvs for browsers, bundlers and Node, as four modules that are loaded when they are needed. Each feature is one of them:
//!
//! - `reconstruction`: a [`Rig`], its [`Frame`]s and their [`Reconstruction`]s;
//! - `calibration`: a [`Rig`], its [`Frame`]s and a [`Calibrator`] that checks the rig;
//! - `forms`: a [`Rig`], its [`Frame`]s and [`Form`]s of their meshes;
//! - `scene`: [`open_scene`].
//!
//! Everything runs on the calling thread: call it in a worker. With the feature `threads`, the work of `reconstruct` and
//! `steady` is shared with the workers that have called [`run_thread`].

#[cfg(feature = "calibration")]
mod calibration;
#[cfg(feature = "forms")]
mod compress;
mod error;
#[cfg(feature = "reconstruction")]
mod executor;
#[cfg(feature = "forms")]
mod form;
#[cfg(feature = "frames")]
mod frame;
#[cfg(feature = "frames")]
mod key;
#[cfg(any(feature = "reconstruction", feature = "forms"))]
mod mesh_arrays;
#[cfg(any(feature = "reconstruction", feature = "forms"))]
mod own_mesh;
#[cfg(feature = "reconstruction")]
mod photograph;
#[cfg(feature = "frames")]
mod presets;
#[cfg(feature = "frames")]
mod progress;
#[cfg(feature = "reconstruction")]
mod reconstruction;
#[cfg(feature = "frames")]
mod rig;
#[cfg(feature = "scene")]
mod scene;
#[cfg(feature = "reconstruction")]
mod sketch;
#[cfg(feature = "reconstruction")]
mod steady;
#[cfg(feature = "threads")]
mod threads;
mod types;
#[cfg(feature = "frames")]
mod warning;

#[cfg(feature = "calibration")]
pub use calibration::Calibrator;
#[cfg(feature = "forms")]
pub use form::Form;
#[cfg(feature = "frames")]
pub use frame::Frame;
#[cfg(any(feature = "reconstruction", feature = "forms"))]
pub use mesh_arrays::MeshArrays;
#[cfg(feature = "reconstruction")]
pub use photograph::Photograph;
#[cfg(feature = "reconstruction")]
pub use reconstruction::{Cloud, Reconstruction};
#[cfg(feature = "frames")]
pub use rig::Rig;
#[cfg(feature = "scene")]
pub use scene::open_scene;
#[cfg(feature = "threads")]
pub use threads::{run_thread, start_threads, threads};

use wasm_bindgen::prelude::*;

/// Turns a defect's panic into a JavaScript error. The instance must not be used afterwards.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| error::throw_panic(&panic.to_string())));
}

/// Version of the library.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}
