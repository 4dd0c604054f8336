//! A view as an importer found it.

use pcmvs_core::Camera;
use std::path::PathBuf;

/// Camera and files of one view.
#[derive(Debug, Clone)]
pub struct ImportedView {
    pub name: String,
    pub camera: Camera,
    /// The file with its calibration.
    pub file: PathBuf,
    /// The photograph.
    pub image: PathBuf,
    /// Its mask, if the source names it. Otherwise the usual folders are searched.
    pub mask: Option<PathBuf>,
    /// When it was taken, in any unit, if the source has pictures of several instants.
    pub time: Option<f64>,
}

/// Three rows from nine numbers.
pub fn rows(m: [f64; 9]) -> [[f64; 3]; 3] {
    [[m[0], m[1], m[2]], [m[3], m[4], m[5]], [m[6], m[7], m[8]]]
}
