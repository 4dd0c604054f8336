//! pcmvs for browsers, bundlers and Node: a [`Rig`], its [`Frame`]s, their [`Reconstruction`]s, and a [`Calibrator`] that
//! checks the rig. Everything runs on the calling thread: call it in a worker.

mod calibration;
mod diagnostics;
mod error;
mod files;
mod frame;
mod key;
mod photograph;
mod presets;
mod progress;
mod reconstruction;
mod rig;
mod sketch;
mod steady;
mod types;

pub use calibration::Calibrator;
pub use frame::Frame;
pub use photograph::Photograph;
pub use reconstruction::{Cloud, MeshArrays, Reconstruction};
pub use rig::Rig;

use error::Failed;
use files::Given;
use serde::Serialize;
use std::{iter, path::Path};
use types::{FileSource, SceneObject};
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

/// Opens the capture among the files, wherever in the tree it is: scene.json, Middlebury's `*_par.txt`, a COLMAP text
/// model, transforms.json or OpenCV's calibrations. Paths in the scene are those of the files.
#[wasm_bindgen(js_name = openScene)]
pub fn open_scene(files: &FileSource) -> Result<SceneObject, Failed> {
    let mut scene = pcmvs_scene::open(&Given::new(files)?, Path::new(""))?;
    let folder = scene.resolve(Path::new(""));
    let of_frames = scene.frames.iter_mut().flat_map(|frame| iter::once(&mut frame.images).chain(&mut frame.masks));
    let plates = scene.background.iter_mut().filter_map(|background| background.plates.as_mut());
    for path in of_frames.chain(plates).flatten().flatten() {
        *path = files::normal(&folder.join(&*path));
    }
    let object = scene.serialize(&serde_wasm_bindgen::Serializer::json_compatible())?;
    Ok(object.unchecked_into())
}
