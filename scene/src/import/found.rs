//! Cameras of files that say nothing about pictures, or only their names.

use super::{
    source::{failure, find_picture, is_picture, picture_size},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::{Camera, Lens};
use std::path::{Path, PathBuf};

/// A camera as a file describes it.
pub struct Found {
    pub name: String,
    /// Name of its picture, or of the folder with its pictures of several instants.
    pub picture: String,
    /// Default: the size of the picture.
    pub size: Option<[u32; 2]>,
    pub k: [[f64; 3]; 3],
    pub lens: Lens,
    pub r: [[f64; 3]; 3],
    pub t: [f64; 3],
}

impl Found {
    /// The views of the camera: one per picture. The pictures are searched in `folders`.
    pub fn views(self, files: &dyn Files, file: &Path, folders: &[PathBuf]) -> Result<Vec<ImportedView>, Failure> {
        let Self { name, picture, size, k, lens, r, t } = self;
        let pictures = pictures(files, folders, &picture)?;
        let Some((first, _)) = pictures.first() else {
            let problem = format!(
                "its picture `{picture}` is missing: put it, or a folder of this name with pictures, in `images`"
            );
            return Err(failure(file, &name, &problem));
        };
        let [width, height] = match size {
            Some(size) => size,
            None => picture_size(files, first, &name)?,
        };
        let camera = Camera { width, height, k, lens, r, t };
        let view = |(image, time): (PathBuf, Option<f64>)| ImportedView {
            name: name.clone(),
            camera,
            file: file.to_path_buf(),
            image,
            mask: None,
            time,
        };
        Ok(pictures.into_iter().map(view).collect())
    }
}

/// The picture of a name, or the pictures in the folder of this name, with the numbers at the end of their names as times.
pub fn pictures(files: &dyn Files, folders: &[PathBuf], name: &str) -> Result<Vec<(PathBuf, Option<f64>)>, Failure> {
    if let Some(single) = find_picture(files, folders, name) {
        return Ok(vec![(single, None)]);
    }
    for folder in folders.iter().map(|folder| folder.join(name)).filter(|folder| files.is_folder(folder)) {
        let entries = files.list(&folder).map_err(|e| Failure::unreadable(&folder, &e))?;
        let pictures: Vec<PathBuf> =
            entries.into_iter().filter(|path| files.is_file(path) && is_picture(path)).collect();
        if !pictures.is_empty() {
            return Ok(pictures
                .into_iter()
                .map(|path| {
                    let time = number(&path);
                    (path, time)
                })
                .collect());
        }
    }
    Ok(Vec::new())
}

/// The number at the end of a file's name, without its extension.
fn number(path: &Path) -> Option<f64> {
    let stem = path.file_stem()?.to_str()?;
    let digits = stem.len() - stem.bytes().rev().take_while(u8::is_ascii_digit).count();
    stem[digits..].parse().ok()
}
