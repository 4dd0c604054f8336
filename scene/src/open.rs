//! Finds a capture in a folder and recognises its format.

use crate::{
    failure::Failure,
    files::Files,
    import::{Source, import},
    scene::{FILE_NAME, Scene},
};
use std::path::{Path, PathBuf};

/// Levels of folders that are searched.
const MAX_DEPTH: usize = 4;

/// Opens the capture in a folder or, if there is none, in the nearest folder below it. A scene.json takes precedence over
/// the calibration of another program. Picture paths of an imported scene are those of its source.
pub fn open(files: &dyn Files, root: &Path) -> Result<Scene, Failure> {
    let unreadable = |folder: &Path, e: &std::io::Error| Failure::unreadable(folder, e);
    let mut folders = vec![root.to_path_buf()];
    for _ in 0..=MAX_DEPTH {
        let mut below = Vec::new();
        for folder in &folders {
            let entries = files.list(folder).map_err(|e| unreadable(folder, &e))?;
            if entries.iter().any(|path| path.file_name().is_some_and(|name| name == FILE_NAME)) {
                return Scene::load(files, folder);
            }
            if let Some((source, path)) = recognise(files, folder, &entries) {
                return import(files, source, &path);
            }
            below.extend(entries.into_iter().filter(|path| files.is_folder(path)));
        }
        folders = below;
    }
    Err(Failure::Input(String::from(
        "no calibrated capture was found: name a folder with scene.json, Middlebury's *_par.txt, a COLMAP text model \
         (cameras.txt, images.txt), transforms.json or OpenCV calibrations, and the pictures",
    )))
}

/// The program whose calibration a folder contains, and the path for [`import`].
fn recognise(files: &dyn Files, folder: &Path, entries: &[PathBuf]) -> Option<(Source, PathBuf)> {
    let ends = |path: &PathBuf, end: &str| path.to_string_lossy().to_lowercase().ends_with(end);
    let has = |name: &str| files.is_file(&folder.join(name));
    let models = ["", "sparse", "sparse/0"].map(|model| folder.join(model));
    if let Some(path) = entries.iter().find(|path| ends(path, "_par.txt")) {
        Some((Source::Middlebury, path.clone()))
    } else if models.iter().any(|m| ["cameras.txt", "cameras.bin"].iter().any(|name| files.is_file(&m.join(name)))) {
        Some((Source::Colmap, folder.to_path_buf()))
    } else if has("transforms.json") || has("transforms_train.json") {
        Some((Source::Transforms, folder.to_path_buf()))
    } else if entries.iter().any(|path| ends(path, ".yml") || ends(path, ".yaml")) {
        Some((Source::Opencv, folder.to_path_buf()))
    } else {
        None
    }
}
