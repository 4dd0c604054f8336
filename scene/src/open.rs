//! Finds a capture in a folder and recognises its format.

use crate::{
    failure::Failure,
    files::Files,
    import::{KNOWN, import, of_folder},
    scene::{FILE_NAME, Scene},
};
use std::path::Path;

/// Levels of folders that are searched.
const MAX_DEPTH: usize = 4;

/// Opens the capture in a folder or, if there is none, in the nearest folder below it. A scene.json takes precedence over
/// the calibration of another program. Videos cannot be opened. Picture paths of an imported scene are those of its source.
pub fn open(files: &dyn Files, root: &Path) -> Result<Scene, Failure> {
    let unreadable = |folder: &Path, e: &std::io::Error| Failure::unreadable(folder, e);
    let mut folders = vec![root.to_path_buf()];
    for _ in 0..=MAX_DEPTH {
        let mut below = Vec::new();
        for folder in &folders {
            let entries = files.list(folder).map_err(|e| unreadable(folder, &e))?;
            if entries.iter().any(|path| path.file_name().is_some_and(|name| name == FILE_NAME)) {
                let scene = Scene::load(files, folder)?;
                return without_videos(&scene.path.clone(), scene);
            }
            if let Some((source, path)) = of_folder(files, folder, &entries).into_iter().next() {
                return without_videos(&path, import(files, source, &path)?.scene);
            }
            below.extend(entries.into_iter().filter(|path| files.is_folder(path)));
        }
        folders = below;
    }
    Err(Failure::Input(format!(
        "no calibrated capture was found: name a folder with scene.json, {KNOWN}, and the pictures"
    )))
}

/// The scene, unless its pictures are videos.
fn without_videos(path: &Path, scene: Scene) -> Result<Scene, Failure> {
    if scene.videos || scene.mask_videos {
        return Err(Failure::Input(format!(
            "{}: its pictures are videos, which only the command line reads: reconstruct it there",
            path.display()
        )));
    }
    Ok(scene)
}
