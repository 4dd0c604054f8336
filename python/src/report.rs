//! What a frame says about its cameras.

use pyo3::prelude::*;

/// Something that may make a result worse although nothing failed.
#[pyclass(frozen, get_all, module = "pcmvs")]
pub struct CaptureWarning {
    /// Stable name of its kind, such as "mask-inverted".
    pub code: &'static str,
    /// Index of the camera that it is about, if it is about one.
    pub camera: Option<u32>,
    /// What is wrong, where, and what to do.
    pub message: String,
}

impl From<&pcmvs_core::Warning> for CaptureWarning {
    fn from(warning: &pcmvs_core::Warning) -> Self {
        Self { code: warning.code(), camera: warning.camera(), message: warning.to_string() }
    }
}

#[pymethods]
impl CaptureWarning {
    fn __repr__(&self) -> String {
        format!("CaptureWarning({}: {})", self.code, self.message)
    }
}

/// How well a camera's view agrees with the others in a frame.
#[pyclass(frozen, get_all, module = "pcmvs")]
pub struct ViewDiagnostics {
    /// Whether the view takes part in the frame.
    pub used: bool,
    /// Intersection over union of the silhouette and the hull's picture, 0 to 1. None without a silhouette.
    pub silhouette_overlap: Option<f32>,
    /// Median distance in pixels of the hull's outline from the silhouette's contour. None without a silhouette.
    pub contour_px: Option<f32>,
    /// Median distance in pixels of a few matches with other views from their epipolar lines: how far off the calibration
    /// is. None before the merge, without stereo, and where there are too few matches.
    pub epipolar_px: Option<f32>,
}

impl From<&pcmvs_core::ViewDiagnostics> for ViewDiagnostics {
    fn from(found: &pcmvs_core::ViewDiagnostics) -> Self {
        let pcmvs_core::ViewDiagnostics { used, silhouette_overlap, contour_px, epipolar_px, .. } = *found;
        Self { used, silhouette_overlap, contour_px, epipolar_px }
    }
}

#[pymethods]
impl ViewDiagnostics {
    fn __repr__(&self) -> String {
        let number = |value: Option<f32>| value.map_or_else(|| String::from("None"), |value| format!("{value:.3}"));
        let [overlap, contour, epipolar] = [self.silhouette_overlap, self.contour_px, self.epipolar_px].map(number);
        format!(
            "ViewDiagnostics(used={}, silhouette_overlap={overlap}, contour_px={contour}, epipolar_px={epipolar})",
            if self.used { "True" } else { "False" }
        )
    }
}
