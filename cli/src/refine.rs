//! `pcmvs refine`: a scene with a corrected calibration.

use crate::{arguments::Refine, calibration::calibrated, output};
use pcmvs_core::calibration::{CalibrationParams, Verdict};
use pcmvs_scene::{Disk, FILE_NAME, Failure, Scene, SceneCamera};
use std::{
    fs,
    mem::take,
    path::{Component, Path, PathBuf},
    sync::atomic::AtomicBool,
};

/// Runs the command.
pub fn run(options: &Refine, cancelled: &AtomicBool) -> Result<(), Failure> {
    let mut scene = Scene::load(&Disk, &options.scene)?;
    let target = options.output.join(FILE_NAME);
    if target.exists() {
        let target = target.display();
        return Err(Failure::Input(format!("{target}: exists already: name another folder or remove that file")));
    }
    let params = CalibrationParams { intrinsics: options.intrinsics, ..CalibrationParams::default() };
    let found = calibrated(&mut scene, &options.evidence, &params, cancelled)?;
    if found.calibration.verdict != Verdict::Improved {
        let path = scene.path.display();
        return Err(Failure::Other(format!("{path}: {}: nothing is written", found.summary())));
    }
    for (camera, refined) in scene.cameras.iter_mut().zip(found.cameras()) {
        *camera = SceneCamera::new(take(&mut camera.name), refined);
    }
    write(scene, &options.output)?;
    println!("{} cameras with a corrected calibration in {}", found.cameras().len(), options.output.display());
    Ok(())
}

/// Writes a scene to another folder, with paths that lead from there to the same files. If that fails, folders that it
/// made are removed again.
fn write(scene: Scene, folder: &Path) -> Result<(), Failure> {
    let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
    let made: Vec<&Path> = folder.ancestors().take_while(is_missing).collect();
    let written = fs::create_dir_all(folder)
        .map_err(|e| Failure::unwritable(folder, &e))
        .and_then(|()| moved(scene, folder))
        .and_then(|scene| output::write_json(&folder.join(FILE_NAME), &scene));
    if written.is_err() {
        // Report the error of the write, not one of the clean-up.
        made.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
    written
}

/// The scene with paths from another folder, which exists. Paths stay relative, so that both can be moved together.
fn moved(mut scene: Scene, folder: &Path) -> Result<Scene, Failure> {
    let canonical = |folder: &Path| folder.canonicalize().map_err(|e| Failure::unreadable(folder, &e));
    let lead = path_between(&canonical(folder)?, &canonical(&scene.resolve(Path::new(".")))?);
    for path in scene.paths_mut() {
        *path = lead.join(&*path);
    }
    Ok(scene)
}

/// The path from one canonical folder to another: relative, unless they share no root.
fn path_between(from: &Path, to: &Path) -> PathBuf {
    let shared = from.components().zip(to.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return to.to_path_buf();
    }
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(to.components().skip(shared)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::{TempDir, tempdir};

    /// A folder with a scene in `captures/scene` that has one picture, one mask, one clean plate, and no second camera.
    fn with_scene() -> (TempDir, Scene) {
        let root = tempdir().unwrap();
        let folder = root.path().join("captures/scene");
        fs::create_dir_all(&folder).unwrap();
        for name in ["image", "mask", "plate"] {
            fs::write(folder.join(name), name).unwrap();
        }
        let camera = r#"{ "name": "c", "width": 1, "height": 1, "t": [0, 0, 1],
            "K": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] }"#;
        let text = format!(
            r#"{{ "version": 1, "cameras": [{camera}, {camera}], "background": {{ "plates": ["plate", null] }},
                "frames": [{{ "index": 0, "images": ["image", null], "masks": ["mask", null] }}] }}"#
        );
        fs::write(folder.join(FILE_NAME), text).unwrap();
        let scene = Scene::load(&Disk, &folder).unwrap();
        (root, scene)
    }

    /// Writes the scene to a folder, and checks that all its paths lead to its files.
    #[track_caller]
    fn assert_leads_back(scene: Scene, folder: &Path) -> Scene {
        write(scene, folder).unwrap();
        let mut written = Scene::load(&Disk, folder).unwrap();
        let paths: Vec<PathBuf> = written.paths_mut().map(|path| path.clone()).collect();
        let contents: Vec<_> = paths.iter().map(|path| fs::read_to_string(written.resolve(path)).unwrap()).collect();
        assert_eq!(contents, ["image", "mask", "plate"]);
        written
    }

    #[test]
    fn paths_lead_from_the_new_folder_to_the_same_files() {
        let (root, scene) = with_scene();
        let beside = assert_leads_back(scene.clone(), &root.path().join("captures/scene2"));
        assert_eq!(beside.frames[0].image(0), Some(Path::new("../scene/image")));
        let inside = assert_leads_back(scene.clone(), &root.path().join("captures/scene/refined"));
        assert_eq!(inside.plate(0), Some(Path::new("../plate")));
        assert_leads_back(scene, &root.path().join("other/deep/scene2"));
    }

    #[test]
    fn absolute_paths_stay() {
        let (root, mut scene) = with_scene();
        let folder = root.path().join("captures/scene");
        scene.paths_mut().for_each(|path| *path = folder.join(&*path));
        let written = assert_leads_back(scene, &root.path().join("scene2"));
        assert_eq!(written.frames[0].mask(0), Some(&*folder.join("mask")));
    }

    #[cfg(unix)]
    #[test]
    fn paths_lead_through_links() {
        let (root, scene) = with_scene();
        fs::create_dir_all(root.path().join("far/away")).unwrap();
        std::os::unix::fs::symlink(root.path().join("far/away"), root.path().join("link")).unwrap();
        assert_leads_back(scene.clone(), &root.path().join("link/new/scene2"));
        std::os::unix::fs::symlink(root.path().join("captures/scene"), root.path().join("far/scene")).unwrap();
        let scene = Scene { path: root.path().join("far/scene").join(FILE_NAME), ..scene };
        assert_leads_back(scene, &root.path().join("scene3"));
    }

    #[test]
    fn nothing_is_left_of_a_folder_that_cannot_be_made() {
        let (root, scene) = with_scene();
        let too_long = "x".repeat(300);
        assert!(matches!(write(scene, &root.path().join("new").join(too_long)), Err(Failure::Other(_))));
        assert!(!root.path().join("new").exists());
    }
}
