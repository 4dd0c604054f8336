//! Keys of OpenCV's calibrations.

use super::{
    lens,
    values::{number, numbers},
};
use serde_json::{Map, Value};

pub const K: &[&str] = &["camera_matrix", "cameraMatrix", "K", "intrinsic_matrix", "mtx"];
pub const DISTORTION: &[&str] =
    &["distortion_coefficients", "distCoeffs", "dist_coeffs", "distortion_coeffs", "D", "distortion", "dist"];
pub const ROTATION: &[&str] = &["R", "rotation_matrix", "rotation", "rvec", "rotation_vector"];
pub const TRANSLATION: &[&str] = &["t", "tvec", "T", "translation", "translation_vector"];
pub const SIZES: [[&str; 2]; 2] = [["image_width", "image_height"], ["width", "height"]];
pub const SIZE: &[&str] = &["image_size"];
pub const SIZE_PARTS: &[&str] = &["image_width", "image_height", "width", "height"];
pub const NAME: &[&str] = &["name"];
pub const IMAGE: &[&str] = &["image", "image_path", "file"];
pub const MASK: &[&str] = &["mask", "mask_path"];
/// Keys that look like calibration but do not change it: OpenCV's and ROS' tools write them beside the calibration.
pub const HARMLESS: &[&str] = &[
    "extrinsic_parameters",
    "projection_matrix",
    "rectification_matrix",
    "std_deviations_intrinsics",
    "std_deviations_extrinsics",
];

pub type Object = Map<String, Value>;

/// The same values, where keys of the file and of its maps that are known in another letter case or with other underscores,
/// such as `Camera_Matrix`, have the known spelling. Short keys differ by their case (`t` and `T`), and those of maps may be
/// names of cameras. Where a key has two spellings, one stays and is refused later.
pub fn spelled(value: Value) -> Value {
    let map = match value {
        Value::Array(list) => return list.into_iter().map(spelled).collect(),
        Value::Object(map) => map,
        other => return other,
    };
    let known = || [K, DISTORTION, ROTATION, TRANSLATION, SIZE, SIZE_PARTS, NAME, IMAGE, MASK].into_iter().flatten();
    let usual = |key: &str| {
        let name = lens::plain(key);
        known().find(|known| name.len() > 2 && lens::plain(known) == name).filter(|usual| !map.contains_key(**usual))
    };
    let mut result = Map::new();
    for (key, value) in &map {
        let usual = usual(key).filter(|usual| as_map(value).is_none() && !result.contains_key(**usual));
        result.insert(usual.map_or_else(|| key.clone(), |usual| String::from(*usual)), spelled(value.clone()));
    }
    result.into()
}

/// A map that is not a matrix.
pub fn as_map(value: &Value) -> Option<&Object> {
    value.as_object().filter(|map| !map.contains_key("data"))
}

/// Refuses keys that hold a matrix with 3 or 4 rows and columns: what is not understood may be a camera.
pub fn check_matrices(keys: &Object) -> Result<(), String> {
    let of_camera = |count: usize| (3..=4).contains(&count);
    let is_matrix = |value: &Value| match value {
        Value::Array(rows) => {
            let row = |row: &Value| row.as_array().is_some_and(|row| of_camera(row.len()));
            of_camera(rows.len()) && rows.iter().all(row) && numbers(value).is_ok()
        }
        Value::Object(matrix) => {
            let count = |key: &str| matrix.get(key).and_then(|count| number(key, count).ok());
            matrix.contains_key("data") && ["rows", "cols"].iter().all(|key| matches!(count(key), Some(3.0 | 4.0)))
        }
        _ => false,
    };
    match keys.iter().find(|(key, value)| !HARMLESS.contains(&key.as_str()) && is_matrix(value)) {
        Some((key, _)) => Err(format!(
            "`{key}` is a matrix that is not understood: if it is that of a camera, use the keys {K:?}, {ROTATION:?} and \
             {TRANSLATION:?}, or else move it away"
        )),
        None => Ok(()),
    }
}
