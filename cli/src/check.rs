//! `pcmvs check`: how well the calibration of a scene fits its pictures.

use crate::{arguments::Check, calibration::calibrated};
use pcmvs_core::calibration::CalibrationParams;
use pcmvs_scene::{Disk, Failure, Scene};
use std::sync::atomic::AtomicBool;

/// Runs the command. Returns whether nothing is doubtful.
pub fn run(options: &Check, cancelled: &AtomicBool) -> Result<bool, Failure> {
    let mut scene = Scene::load(&Disk, &options.scene)?;
    if let Some(list) = &options.cameras {
        scene.select_cameras(&list.0)?;
    }
    let found = calibrated(&mut scene, &options.evidence, &CalibrationParams::default(), true, cancelled)?;
    if options.json {
        println!("{:#}", found.to_json(&scene));
    }
    Ok(!found.is_doubtful())
}
