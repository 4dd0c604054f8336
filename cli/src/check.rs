//! `pcmvs check`: how well the calibration of a scene fits its pictures.

use crate::{
    arguments::Check,
    calibration::{Run, evidence},
    progress::Console,
    reconstruct::{scene_cameras, silhouettes, thread_count},
    threads::Threads,
};
use pcmvs_core::calibration::CalibrationParams;
use pcmvs_scene::{Disk, Failure, Scene};
use std::sync::atomic::AtomicBool;

/// Runs the command. Returns whether nothing is doubtful.
pub fn run(options: &Check, cancelled: &AtomicBool) -> Result<bool, Failure> {
    let mut scene = Scene::load(&Disk, &options.scene)?;
    if let Some(list) = &options.cameras {
        scene.select_cameras(&list.0)?;
    }
    let cameras = scene_cameras(&scene)?;
    let silhouettes = silhouettes(options.evidence.masks, &scene)?;
    let threads = Threads::new(thread_count(options.evidence.threads))?;
    let console = Console::new(cancelled);
    let frames = evidence(&scene, options.evidence.frames.as_ref().map(|list| list.0.as_slice()))?;
    let run = Run { scene: &scene, silhouettes, threads: &threads, console: &console };
    let found = run.calibrate(&cameras, &frames, &CalibrationParams::default())?;
    found.print(&scene, &console);
    if options.json {
        println!("{:#}", found.to_json(&scene));
    }
    Ok(found.calibration.findings.is_empty())
}
