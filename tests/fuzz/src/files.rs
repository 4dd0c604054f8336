//! Files in memory.

use pcmvs_scene::Files;
use std::{
    collections::BTreeMap,
    io,
    path::{Path, PathBuf},
};

/// A gray PNG of 8 x 8 pixels.
pub const PICTURE: &[u8] = include_bytes!("picture.png");

/// Some files, and pictures under every name that ends like one.
#[derive(Default)]
pub struct Tree(pub BTreeMap<PathBuf, Vec<u8>>);

fn is_picture(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "png")
}

impl Files for Tree {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        match self.0.get(path) {
            Some(bytes) => Ok(bytes.clone()),
            None if is_picture(path) => Ok(PICTURE.to_vec()),
            None => Err(io::ErrorKind::NotFound.into()),
        }
    }

    fn is_file(&self, path: &Path) -> bool {
        self.0.contains_key(path) || is_picture(path)
    }

    fn is_folder(&self, path: &Path) -> bool {
        self.0.keys().any(|file| file != path && file.starts_with(path))
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        let below = self.0.keys().filter_map(|file| file.strip_prefix(folder).ok()?.components().next());
        let mut entries: Vec<PathBuf> = below.map(|name| folder.join(name)).collect();
        entries.dedup();
        Ok(entries)
    }
}
