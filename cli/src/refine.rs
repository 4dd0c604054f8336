//! `pcmvs refine`: a scene with a corrected calibration.

use crate::{arguments::Refine, calibration::calibrated, output};
use pcmvs_core::calibration::{CalibrationParams, Verdict};
use pcmvs_scene::{Disk, Document, FILE_NAME, Failure, Scene, SceneCamera};
use serde_json::json;
use std::{
    fs,
    path::{Component, Path, PathBuf},
    sync::atomic::AtomicBool,
};

/// Name of the file with the cameras, if the scene has them in a file of their own.
const RIG_NAME: &str = "rig.json";

/// Runs the command.
pub fn run(options: &Refine, cancelled: &AtomicBool) -> Result<(), Failure> {
    let mut scene = Scene::load(&Disk, &options.scene)?;
    let document = Document::load(&Disk, &options.scene)?;
    let names = if document.has_rig() { &[FILE_NAME, RIG_NAME][..] } else { &[FILE_NAME] };
    if let Some(target) = names.iter().map(|name| options.output.join(name)).find(|target| target.exists()) {
        let target = target.display();
        return Err(Failure::Input(format!("{target}: exists already: name another folder or remove that file")));
    }
    let params = CalibrationParams { intrinsics: options.intrinsics, ..CalibrationParams::default() };
    let found = calibrated(&mut scene, &options.evidence, &params, false, cancelled)?;
    if found.calibration.verdict != Verdict::Improved {
        let path = scene.path.display();
        return Err(Failure::Other(format!("{path}: {}: nothing is written", found.summary())));
    }
    for (camera, refined) in scene.cameras.iter_mut().zip(found.cameras()) {
        *camera = SceneCamera::new(camera.name.clone(), refined);
    }
    let count = scene.cameras.len();
    write(scene, document, &options.output)?;
    println!("{count} cameras with a corrected calibration in {}", options.output.display());
    Ok(())
}

/// Writes the document of a scene with its cameras to another folder, with paths that lead from there to the same files.
/// If that fails, folders and files that it made are removed again.
fn write(scene: Scene, document: Document, folder: &Path) -> Result<(), Failure> {
    let is_missing = |folder: &&Path| !folder.as_os_str().is_empty() && !folder.exists();
    let made: Vec<&Path> = folder.ancestors().take_while(is_missing).collect();
    let written = fs::create_dir_all(folder)
        .map_err(|e| Failure::unwritable(folder, &e))
        .and_then(|()| write_into(scene, document, folder));
    if written.is_err() {
        // Report the error of the write, not one of the clean-up.
        made.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    }
    written
}

/// The same, to a folder that exists. Cameras that come from a file of their own go to one, so that other takes can use
/// them, too.
fn write_into(scene: Scene, mut document: Document, folder: &Path) -> Result<(), Failure> {
    document.move_to(&lead(&scene, folder)?);
    if !document.has_rig() {
        document.set_cameras(&scene.cameras);
        return output::write_json(&folder.join(FILE_NAME), &document);
    }
    let (rig, Scene { version, units, up, cameras, .. }) = (folder.join(RIG_NAME), scene);
    document.0.insert(String::from("rig"), RIG_NAME.into());
    output::write_json(&rig, &json!({ "version": version, "units": units, "up": up, "cameras": cameras }))?;
    output::write_json(&folder.join(FILE_NAME), &document).inspect_err(|_| drop(fs::remove_file(rig)))
}

/// The path from another folder, which exists, to that of the scene. It is relative, so that both can be moved together.
fn lead(scene: &Scene, folder: &Path) -> Result<PathBuf, Failure> {
    let canonical = |folder: &Path| folder.canonicalize().map_err(|e| Failure::unreadable(folder, &e));
    Ok(path_between(&canonical(folder)?, &canonical(&scene.resolve(Path::new(".")))?))
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

    const LIST: &str = r#""frames": [{ "index": 7, "images": ["image", null], "masks": ["mask", null] }]"#;
    const RANGE: &str =
        r#""images": ["{camera}age", null], "masks": ["mask", null], "frames": { "first": 7, "last": 7 }"#;
    const CAMERAS: &str = r#"[
        { "name": "im", "width": 1, "height": 1, "t": [0, 0, 1],
          "K": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] },
        { "name": "b", "width": 1, "height": 1, "t": [0, 0, 2],
          "K": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] } ]"#;

    /// A folder with a scene in `captures/scene {1}` that has one picture, one mask, one clean plate, and no picture of the
    /// second camera.
    fn with_scene(frames: &str, cameras: &str) -> (TempDir, PathBuf) {
        let root = tempdir().unwrap();
        let folder = root.path().join("captures/scene {1}");
        fs::create_dir_all(&folder).unwrap();
        for name in ["image", "mask", "plate"] {
            fs::write(folder.join(name), name).unwrap();
        }
        let text = format!(
            r#"{{ "version": 1, {cameras}, {frames}, "offsets": {{ "b": 2 }}, "background": {{ "plates": ["plate", null] }} }}"#
        );
        fs::write(folder.join(FILE_NAME), text).unwrap();
        (root, folder)
    }

    fn with_own_cameras(frames: &str) -> (TempDir, PathBuf) {
        with_scene(frames, &format!(r#""cameras": {CAMERAS}"#))
    }

    /// Writes a scene with moved cameras to a folder.
    fn rewrite(scene: &Path, folder: &Path) -> Result<(), Failure> {
        let (mut cameras, document) = (Scene::load(&Disk, scene)?, Document::load(&Disk, scene)?);
        cameras.cameras[0].t[2] = 5.0;
        write(cameras, document, folder)
    }

    /// The same. Checks that all its paths lead to its files.
    #[track_caller]
    fn assert_leads_back(scene: &Path, folder: &Path) -> Scene {
        rewrite(scene, folder).unwrap();
        let written = Scene::load(&Disk, folder).unwrap();
        let frame = &written.frames[0];
        let contents = [frame.image(0), frame.mask(0), written.plate(0)]
            .map(|path| fs::read_to_string(written.resolve(path.unwrap())).unwrap());
        assert_eq!(contents, ["image", "mask", "plate"]);
        assert_eq!((written.cameras[0].t[2], written.cameras[1].offset, frame.index), (5.0, 2, 7));
        written
    }

    #[test]
    fn paths_lead_from_the_new_folder_to_the_same_files() {
        for frames in [LIST, RANGE] {
            let (root, scene) = with_own_cameras(frames);
            let beside = assert_leads_back(&scene, &root.path().join("captures/scene2"));
            assert_eq!(beside.frames[0].image(0), Some(Path::new("../scene {1}/image")));
            let inside = assert_leads_back(&scene, &scene.join("refined"));
            assert_eq!(inside.plate(0), Some(Path::new("../plate")));
            assert_leads_back(&scene, &root.path().join("other/deep/scene2"));
        }
    }

    #[test]
    fn absolute_paths_stay() {
        for frames in [LIST, RANGE] {
            let (root, scene) = with_own_cameras(frames);
            let file = scene.join(FILE_NAME);
            let mask = scene.join("mask").to_string_lossy().into_owned();
            let literal = if frames == RANGE { mask.replace('{', "{{").replace('}', "}}") } else { mask.clone() };
            let text = fs::read_to_string(&file).unwrap().replace(r#""mask""#, &format!("{literal:?}"));
            fs::write(&file, text).unwrap();
            let written = assert_leads_back(&scene, &root.path().join("scene2"));
            assert_eq!(written.frames[0].mask(0), Some(Path::new(&mask)));
        }
    }

    #[test]
    fn shared_cameras_go_to_a_file_that_other_takes_can_share() {
        let (root, scene) = with_scene(RANGE, r#""rig": "../rig.json""#);
        let rig = root.path().join("captures/rig.json");
        let text = format!(r#"{{ "version": 1, "up": [0, 0, 1], "cameras": {CAMERAS} }}"#);
        fs::write(&rig, &text).unwrap();
        let folder = root.path().join("scene2");
        let written = assert_leads_back(&scene, &folder);
        assert_eq!((written.rig, written.up), (Some(folder.join(RIG_NAME)), Some([0.0, 0.0, 1.0])));
        assert_eq!(fs::read_to_string(rig).unwrap(), text);
        // Another take.
        fs::write(
            scene.join(FILE_NAME),
            r#"{ "version": 1, "rig": "../../scene2/rig.json", "frames": [ { "index": 0, "images": [null, null] } ] }"#,
        )
        .unwrap();
        assert_eq!(Scene::load(&Disk, &scene).unwrap().cameras[0].t[2], 5.0);
    }

    #[cfg(unix)]
    #[test]
    fn paths_lead_through_links() {
        let (root, scene) = with_own_cameras(LIST);
        fs::create_dir_all(root.path().join("far/away")).unwrap();
        std::os::unix::fs::symlink(root.path().join("far/away"), root.path().join("link")).unwrap();
        assert_leads_back(&scene, &root.path().join("link/new/scene2"));
        std::os::unix::fs::symlink(scene, root.path().join("far/scene")).unwrap();
        assert_leads_back(&root.path().join("far/scene"), &root.path().join("scene3"));
    }

    #[test]
    fn nothing_is_left_of_a_folder_that_cannot_be_made() {
        let (root, scene) = with_own_cameras(LIST);
        let too_long = "x".repeat(300);
        assert!(matches!(rewrite(&scene, &root.path().join("new").join(too_long)), Err(Failure::Other(_))));
        assert!(!root.path().join("new").exists());
    }
}
