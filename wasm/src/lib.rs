//! pcmvs for browsers, bundlers and Node: a [`Rig`], its [`Frame`]s, their [`Reconstruction`]s. Everything runs on the
//! calling thread: call it in a worker.

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
mod types;

pub use frame::Frame;
pub use photograph::Photograph;
pub use reconstruction::{Cloud, MeshArrays, Reconstruction};
pub use rig::Rig;

use error::Failed;
use files::Given;
use serde::Serialize;
use std::path::{Path, PathBuf};
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
    for frame in 0..scene.frames.len() {
        let normal = |path: &Option<PathBuf>| path.as_ref().map(|path| files::normal(&scene.resolve(path)));
        let images = scene.frames[frame].images.iter().map(normal).collect();
        let masks = scene.frames[frame].masks.iter().flatten().map(normal).collect();
        (scene.frames[frame].images, scene.frames[frame].masks) =
            (images, Some(masks).filter(|m: &Vec<_>| !m.is_empty()));
    }
    let object = scene.serialize(&serde_wasm_bindgen::Serializer::json_compatible())?;
    Ok(object.unchecked_into())
}
