//! Warnings as report.json and the terminal give them.

use pcmvs_core::Warning;
use pcmvs_scene::{MissingFile, Scene, SceneFrame};
use serde::{Deserialize, Serialize};

/// Something that may make a result worse although nothing failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct WarningReport {
    /// Stable name of its kind, in kebab-case.
    pub code: String,
    /// Index of the frame; null if it is about the cameras.
    pub frame: Option<u32>,
    /// Name of the camera; null if it is not about one.
    pub camera: Option<String>,
    /// What is wrong, where, and what to do.
    pub message: String,
}

impl WarningReport {
    /// A file of a frame that does not exist.
    pub fn of_missing(file: MissingFile, scene: &Scene, frame: &SceneFrame) -> Self {
        Self {
            code: file.code.to_owned(),
            frame: Some(frame.index),
            camera: Some(scene.cameras[file.camera].name.clone()),
            message: file.message,
        }
    }

    /// A warning of the core. `frame` is `None` if it is about the cameras.
    pub fn of_core(warning: &Warning, scene: &Scene, frame: Option<&SceneFrame>) -> Self {
        Self {
            code: warning.code().to_owned(),
            frame: frame.map(|frame| frame.index),
            camera: warning.camera().map(|camera| scene.cameras[camera as usize].name.clone()),
            message: scene.explain_warning(warning, frame),
        }
    }
}
