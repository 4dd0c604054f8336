//! Opens a scene from the files that JavaScript hands in.

use crate::error::Failed;
use js_sys::Uint8Array;
use pcmvs_scene::Files;
use serde::Serialize;
use std::{
    collections::BTreeSet,
    io, iter,
    path::{Component, Path, PathBuf},
};
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** scene.json, or another program's calibration turned into it. */
export interface Scene {
    version: number;
    units?: string;
    up?: [number, number, number];
    fps?: number;
    cameras: Camera[];
    frames: { index: number; images: (string | null)[]; masks?: (string | null)[] }[];
    background?: {
        chroma_rgb?: [number, number, number];
        colours?: [number, number, number][];
        plates?: (string | null)[];
    };
}

/** Files by their paths, with `/` between folders. */
export interface FileSource {
    paths(): string[];
    read(path: string): Uint8Array;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `Scene`.
    #[wasm_bindgen(typescript_type = "Scene")]
    pub type SceneObject;

    /// `FileSource`.
    #[wasm_bindgen(typescript_type = "FileSource")]
    pub type FileSource;
    /// Paths of all files.
    #[wasm_bindgen(method, catch)]
    pub fn paths(this: &FileSource) -> Result<Vec<String>, JsValue>;
    /// All bytes of a file.
    #[wasm_bindgen(method, catch)]
    pub fn read(this: &FileSource, path: &str) -> Result<Uint8Array, JsValue>;
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
        *path = normal(&folder.join(&*path));
    }
    let object = scene.serialize(&serde_wasm_bindgen::Serializer::json_compatible())?;
    Ok(object.unchecked_into())
}

/// The files and the folders in their paths.
struct Given<'a> {
    source: &'a FileSource,
    files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
}

impl<'a> Given<'a> {
    /// Lists the source's paths.
    fn new(source: &'a FileSource) -> Result<Self, JsValue> {
        let mut files = BTreeSet::new();
        for path in source.paths()? {
            files.insert(PathBuf::from(path));
        }
        let folders = files.iter().flat_map(|file| file.ancestors().skip(1)).map(Path::to_path_buf).collect();
        Ok(Self { source, files, folders })
    }
}

impl Files for Given<'_> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let path = normal(path);
        if !self.files.contains(&path) {
            return Err(io::Error::new(io::ErrorKind::NotFound, "there is no such file"));
        }
        let thrown = |e: JsValue| {
            let message = e.dyn_ref::<js_sys::Error>().map(|e| String::from(e.message()));
            io::Error::other(message.unwrap_or_else(|| String::from("the file cannot be read")))
        };
        let bytes: Uint8Array = self.source.read(&path.to_string_lossy()).map_err(thrown)?;
        Ok(bytes.to_vec())
    }

    fn is_file(&self, path: &Path) -> bool {
        self.files.contains(&normal(path))
    }

    fn is_folder(&self, path: &Path) -> bool {
        self.folders.contains(&normal(path))
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        let folder = normal(folder);
        let entries = self.files.union(&self.folders).filter(|path| path.parent() == Some(&folder));
        Ok(entries.cloned().collect())
    }
}

/// A path without `.` and `..`, as the source spells it.
fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::Normal(name) => out.push(name),
            Component::ParentDir => drop(out.pop()),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    out
}
