//! Lens models. A scene holds OpenCV's model with k1 k2 p1 p2 k3; any other lens is an error.

use super::values::{Levels, find, is_neutral, number};
use serde_json::{Map, Value};

/// What to do about a lens that a scene cannot hold.
pub const REMEDY: &str = "undistort the pictures first, and import the calibration of the undistorted pictures";
/// Keys whose value names a lens model.
pub const MODEL_KEYS: &[&str] = &[
    "camera_model",
    "cameraModel",
    "distortion_model",
    "distortionModel",
    "lens_model",
    "lensModel",
    "projection_model",
    "projectionModel",
    "distortion_type",
    "projection_type",
    "projection",
    "lens_type",
];
/// Models that are OpenCV's or special cases of it. The coefficients decide whether a scene can hold them.
const MODELS: &[&str] = &[
    "",
    "none",
    "null",
    "pinhole",
    "simplepinhole",
    "perspective",
    "opencv",
    "fullopencv",
    "simpleradial",
    "radial",
    "brown",
    "brownconrady",
    "plumbbob",
    "radtan",
    "pinholeradtan",
    "radialtangential",
    "rationalpolynomial",
    "standard",
    "opencvpinhole",
    "pinholeopencv",
    "pinholecamera",
    "pinholebrown",
];
/// Parts of the names of other models, for keys that may also name the maker's model.
const OTHER_MODELS: &[&str] = &[
    "fish",
    "equidist",
    "equirect",
    "omnidir",
    "spheric",
    "panoram",
    "kannala",
    "latlong",
    "catadioptric",
    "ftheta",
    "orthog",
];
/// Names of other models, whatever the key is.
const OTHER_NAMES: &[&str] = &[
    "fisheye",
    "opencvfisheye",
    "simpleradialfisheye",
    "radialfisheye",
    "thinprismfisheye",
    "equidistant",
    "equirectangular",
    "omnidirectional",
    "omnidir",
    "omni",
    "kannalabrandt",
    "kannalabrandt4",
    "kannalabrandt8",
    "unified",
    "eucm",
    "doublesphere",
    "spherical",
    "panoramic",
    "orthographic",
    "kb",
    "kb4",
    "kb8",
    "mei",
    "ucm",
    "fov",
    "fisheye624",
];
/// Keys whose value is a name or a path.
const NAMES_OF_FILES: &[&str] = &["name", "image", "image_path", "file", "file_path", "mask", "mask_path"];
/// Parts of keys that belong to other models. They are harmless if their value is zero or false.
const OTHER_KEYS: &[&str] = &[
    "fish",
    "omni",
    "ftheta",
    "latlong",
    "equirect",
    "spherical",
    "panoram",
    "rollingshutter",
    "orthographic",
    "thinprism",
];
/// Coefficients by name that a scene holds, in its order.
const HELD: [&str; 5] = ["k1", "k2", "p1", "p2", "k3"];
/// Coefficients by name that a scene cannot hold.
const BEYOND: &[&str] = &["k4", "k5", "k6", "s1", "s2", "s3", "s4", "p3", "p4", "tau_x", "tau_y", "b1", "b2"];
/// All coefficients that are read by name.
pub const NAMED: &[&str] =
    &["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "p3", "p4", "tau_x", "tau_y", "b1", "b2"];

/// Lower-case letters and digits of a name, so that spellings of the same name agree.
pub fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Refuses keys that say that the lens is not OpenCV's pinhole model.
pub fn check_model(object: &Map<String, Value>) -> Result<(), String> {
    for (key, value) in object {
        if let Value::Object(inner) = value {
            check_model(inner).map_err(|problem| format!("{key}: {problem}"))?;
        }
        let name = plain(key);
        if (OTHER_KEYS.iter().any(|part| name.contains(part)) || name == "xi") && !is_neutral(value) {
            return Err(format!("`{key}` says that the lens is not a pinhole with OpenCV's distortion: {REMEDY}"));
        }
        let model = value.as_str().map(plain);
        let vague = ["type", "cameratype"].contains(&name.as_str())
            || ["model", "lens", "projection"].iter().any(|part| name.contains(part));
        let refused = match model.as_deref() {
            Some(model) if MODEL_KEYS.contains(&key.as_str()) => !MODELS.contains(&model),
            Some(model) => {
                OTHER_NAMES.contains(&model) && !NAMES_OF_FILES.contains(&key.as_str())
                    || vague && OTHER_MODELS.iter().any(|part| model.contains(part))
            }
            None => MODEL_KEYS.contains(&key.as_str()) && !is_neutral(value),
        };
        if refused {
            return Err(format!("{key} {value} is not supported: {REMEDY}"));
        }
    }
    Ok(())
}

/// Distortion from OpenCV's list k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y.
pub fn from_list(key: &str, list: &[f64]) -> Result<[f64; 5], String> {
    if let Some(&value) = list.iter().skip(5).find(|&&v| v != 0.0) {
        let model = if list.len() <= 8 { "rational" } else { "rational, thin prism or tilted" };
        return Err(format!(
            "{key} has the coefficient {value} beyond k1 k2 p1 p2 k3, of OpenCV's {model} model, which is not supported: \
             {REMEDY}, or calibrate without CALIB_RATIONAL_MODEL, CALIB_THIN_PRISM_MODEL and CALIB_TILTED_MODEL"
        ));
    }
    if !matches!(list.len(), 0..=2 | 4 | 5 | 8 | 12 | 14) && list.iter().any(|&v| v != 0.0) {
        return Err(format!(
            "{key} has {} numbers, but OpenCV's model has 4, 5, 8, 12 or 14: write k1 k2 p1 p2 k3",
            list.len()
        ));
    }
    Ok(std::array::from_fn(|i| list.get(i).copied().unwrap_or(0.0)))
}

/// Distortion from coefficients by name. None if there are none.
pub fn from_names(levels: &Levels) -> Result<Option<[f64; 5]>, String> {
    for object in &levels.0 {
        for &name in BEYOND {
            if let Some((key, value)) = find(object, &[name])
                && number(&key, value)? != 0.0
            {
                return Err(format!("the lens has the coefficient {name} = {value}, which is not supported: {REMEDY}"));
            }
        }
    }
    let found: Vec<Option<f64>> = HELD.iter().map(|&name| levels.number(&[name])).collect::<Result<_, _>>()?;
    Ok(found.iter().any(Option::is_some).then(|| std::array::from_fn(|i| found[i].unwrap_or(0.0))))
}
