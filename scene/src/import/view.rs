//! A view as an importer found it.

use super::values::to_array;
use glam::{DMat3, DQuat, DVec3};
use pcmvs_core::Camera;
use std::path::PathBuf;

/// Camera and files of one view.
#[derive(Debug, Clone)]
pub struct ImportedView {
    pub name: String,
    pub camera: Camera,
    /// The file with its calibration.
    pub file: PathBuf,
    /// The photograph, or the video.
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

/// A rotation from nine numbers by rows, or from Rodrigues' vector (axis times angle in radians).
pub fn rotation(numbers: &[f64]) -> Result<[[f64; 3]; 3], String> {
    match *numbers {
        [x, y, z] => {
            let vector = DVec3::new(x, y, z);
            let (sine, cosine) = libm::sincos(0.5 * vector.length());
            let axis = vector.normalize_or_zero() * sine;
            let matrix = DMat3::from_quat(DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine));
            Ok(matrix.transpose().to_cols_array_2d())
        }
        _ => to_array(numbers, "R").map(rows),
    }
}
