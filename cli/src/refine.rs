//! `pcmvs refine`: a scene with a corrected calibration.

use crate::{
    arguments::Refine,
    calibration::{Run, evidence},
    output,
    progress::Console,
    reconstruct::{chroma_key, scene_cameras, thread_count},
    threads::Threads,
};
use pcmvs_core::calibration::{CalibrationParams, Verdict};
use pcmvs_scene::{Disk, FILE_NAME, Failure, Scene};
use std::{
    path::{Path, PathBuf, absolute},
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
    let key = chroma_key(options.evidence.masks, &scene)?;
    let threads = Threads::new(thread_count(options.evidence.threads))?;
    let console = Console::new(cancelled);
    let frames = evidence(&scene, options.evidence.frames.as_ref().map(|list| list.0.as_slice()))?;
    let run = Run { scene: &scene, key, threads: &threads, console: &console };
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
    // Paths are relative to the folder of scene.json, which is another one now.
    let unreadable = |path: &Path, e: &std::io::Error| Failure::unreadable(path, e);
    let moved = |path: &Path| -> Result<PathBuf, Failure> {
        let path = scene.path.parent().unwrap_or(Path::new("")).join(path);
        absolute(&path).map_err(|e| unreadable(&path, &e))
    };
    let mut rewritten = scene.frames.clone();
    for frame in &mut rewritten {
        for image in &mut frame.images {
            *image = moved(image)?;
        }
        for mask in frame.masks.iter_mut().flatten().flatten() {
            *mask = moved(mask)?;
        }
    }
    scene.frames = rewritten;
    output::write_json(&target, &scene)?;
    println!("{} cameras with a corrected calibration in {}", scene.cameras.len(), options.output.display());
    Ok(())
}
