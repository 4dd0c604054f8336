//! `pcmvs refine`: a scene with a corrected calibration.

use crate::{
    arguments::Refine,
    calibration::{Run, evidence},
    output,
    progress::Console,
    reconstruct::{scene_cameras, silhouettes, thread_count},
    threads::Threads,
};
use pcmvs_core::calibration::{CalibrationParams, Verdict};
use pcmvs_scene::{Disk, FILE_NAME, Failure, Scene, SceneFrame};
use std::{
    path::{Component, Path, PathBuf, absolute},
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
    let cameras = scene_cameras(&scene)?;
    let silhouettes = silhouettes(options.evidence.masks, &scene)?;
    let threads = Threads::new(thread_count(options.evidence.threads))?;
    let console = Console::new(cancelled);
    let frames = evidence(&scene, options.evidence.frames.as_ref().map(|list| list.0.as_slice()))?;
    let run = Run { scene: &scene, silhouettes, threads: &threads, console: &console };
    let params = CalibrationParams { intrinsics: options.intrinsics, ..CalibrationParams::default() };
    let found = run.calibrate(&cameras, &frames, &params)?;
    found.print(&scene, &console);
    if found.calibration.verdict != Verdict::Improved {
        let path = scene.path.display();
        return Err(Failure::Other(format!("{path}: {}: nothing is written", found.summary())));
    }
    for (camera, refined) in scene.cameras.iter_mut().zip(found.cameras()) {
        (camera.k, camera.r, camera.t) = (refined.k, refined.r, refined.t);
        camera.distortion = refined.distortion.to_vec();
    }
    let frames = scene.frames.iter().map(|frame| seen_from(&scene, frame, &options.output)).collect();
    scene.frames = frames;
    output::write_json(&target, &scene)?;
    println!("{} cameras with a corrected calibration in {}", scene.cameras.len(), options.output.display());
    Ok(())
}

/// A frame whose paths lead from another folder to the same files.
fn seen_from(scene: &Scene, frame: &SceneFrame, folder: &Path) -> SceneFrame {
    let mut frame = frame.clone();
    let paths = frame.images.iter_mut().chain(frame.masks.iter_mut().flatten());
    for path in paths.flatten() {
        *path = path_from(folder, &scene.resolve(path));
    }
    frame
}

/// The path of a file from a folder: relative if both are on one file system tree, so that the scenes can be moved
/// together.
fn path_from(folder: &Path, file: &Path) -> PathBuf {
    let full = |path: &Path| path.canonicalize().or_else(|_| absolute(path)).unwrap_or_else(|_| path.to_path_buf());
    // The folder may not exist yet. Its parent then does, or is made with it.
    let name = folder.file_name().unwrap_or_default();
    let folder = match folder.parent() {
        Some(parent) if !folder.exists() && !parent.as_os_str().is_empty() => full(parent).join(name),
        Some(_) if !folder.exists() => full(Path::new(".")).join(name),
        _ => full(folder),
    };
    let file = full(file);
    let (from, to): (Vec<_>, Vec<_>) = (folder.components().collect(), file.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return file;
    }
    let up = from[shared..].iter().map(|_| Component::ParentDir);
    up.chain(to[shared..].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_from_one_folder_to_the_other() {
        let root = std::env::temp_dir();
        let from = |folder: &str| path_from(&root.join(folder), &root.join("scene/images/a.png"));
        assert_eq!(from("scene2"), Path::new("../scene/images/a.png"));
        assert_eq!(from("scene"), Path::new("images/a.png"));
    }
}
