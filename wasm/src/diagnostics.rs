//! Warnings and figures of views as JavaScript reads them.

use pcmvs_core::ViewDiagnostics;
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

/// `ViewReport`.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ViewReport {
    used: bool,
    silhouette_overlap: Option<f32>,
    contour_px: Option<f32>,
    epipolar_px: Option<f32>,
}

impl From<&ViewDiagnostics> for ViewReport {
    fn from(found: &ViewDiagnostics) -> Self {
        let ViewDiagnostics { used, silhouette_overlap, contour_px, epipolar_px, .. } = *found;
        Self { used, silhouette_overlap, contour_px, epipolar_px }
    }
}
