//! Files that JavaScript hands in, as the tree from which a scene is read.

use crate::types::FileSource;
use js_sys::Uint8Array;
use pcmvs_scene::Files;
use std::{
    collections::BTreeSet,
    io,
    path::{Component, Path, PathBuf},
};
use wasm_bindgen::JsCast;

/// The files and the folders in their paths.
pub struct Given<'a> {
    source: &'a FileSource,
    files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
}

impl<'a> Given<'a> {
    /// Lists the source's paths.
    pub fn new(source: &'a FileSource) -> Result<Self, wasm_bindgen::JsValue> {
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
        let thrown = |e: wasm_bindgen::JsValue| {
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
pub fn normal(path: &Path) -> PathBuf {
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
