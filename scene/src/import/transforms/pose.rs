//! The pose of a frame.

use crate::import::values::numbers;
use glam::{DMat3, DVec3};
use serde_json::Value;

/// World to camera with y down and z forward.
pub struct Pose {
    /// Rotation by rows.
    pub r: [[f64; 3]; 3],
    pub t: [f64; 3],
    /// The length that the matrix' axes had before they were made 1 long; exactly 1 if they were not changed.
    pub scale: f64,
}

/// Reads camera to world with y up and z backward: a matrix with three rows and perhaps 0 0 0 1 below them. Axes of equal
/// length, such as those of a scaled object in Blender, are made 1 long.
pub fn world_to_camera(matrix: &Value) -> Result<Pose, String> {
    let wrong = |problem: &str| format!("transform_matrix {problem}");
    let rows = matrix.as_array().ok_or_else(|| wrong("is not a matrix: write 4 rows of 4 numbers"))?;
    let nested = rows.iter().all(|row| row.as_array().is_some_and(|row| row.len() == 4));
    let list = numbers(matrix).map_err(|problem| wrong(&format!("has a wrong entry: {problem}")))?;
    // Some data sets have 0 0 0 1 twice.
    let complete = matches!(list.len(), 12 | 16 | 20);
    if !complete || !(nested || rows.iter().all(|row| !row.is_array())) {
        return Err(wrong("must have 3 or 4 rows of 4 numbers: export it again"));
    }
    if list[12..].chunks_exact(4).any(|row| row != [0.0, 0.0, 0.0, 1.0]) {
        return Err(wrong("must have 0 0 0 1 in its last row: it may be transposed, export it by rows"));
    }
    let row = |i: usize| [list[4 * i], list[4 * i + 1], list[4 * i + 2]];
    // The rows are taken as columns, which gives the inverse rotation.
    let rotation = DMat3::from_cols_array_2d(&[row(0), row(1), row(2)]);
    let scale = common_length(&rotation.transpose());
    let rotation = if scale == 1.0 { rotation } else { rotation * (1.0 / scale) };
    let rotation = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)) * rotation;
    let translation = -(rotation * DVec3::new(list[3], list[7], list[11]));
    Ok(Pose { r: rotation.transpose().to_cols_array_2d(), t: translation.to_array(), scale })
}

/// The length of axes that are equally long and clearly not 1 long. Others are left to the check of the camera.
fn common_length(axes: &DMat3) -> f64 {
    let lengths = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
    let equal = lengths.iter().all(|length| (length - lengths[0]).abs() <= 1e-5 * lengths[0]);
    if equal && lengths[0] > 0.0 && (lengths[0] - 1.0).abs() > 1e-4 { lengths[0] } else { 1.0 }
}
