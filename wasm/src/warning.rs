//! Warnings as JavaScript reads them.

use serde::Serialize;

/// `Warning`.
#[derive(Serialize)]
pub struct Warning {
    pub code: &'static str,
    pub camera: Option<u32>,
    pub message: String,
}

impl From<&pcmvs_core::Warning> for Warning {
    fn from(warning: &pcmvs_core::Warning) -> Self {
        Self {
            code: warning.code(),
            camera: warning.camera(),
            message: warning.problem(|camera| format!("camera {camera}")),
        }
    }
}
