//! Lens models. A scene holds OpenCV's model with up to twelve coefficients and OpenCV's fisheye; any other lens is an
//! error.

use super::values::{Levels, find, is_neutral, number};
use crate::lens::{self, LensModel};
use pcmvs_core::Lens;
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
/// Those that say nothing about the distortion.
const PROJECTIONS: &[&str] = &[
    "pinhole",
    "simplepinhole",
    "perspective",
    "opencv",
    "standard",
    "opencvpinhole",
    "pinholeopencv",
    "pinholecamera",
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
/// Names of OpenCV's fisheye and of special cases of it, whatever the key is.
const FISHEYES: &[&str] = &[
    "fisheye",
    "opencvfisheye",
    "fisheyeopencv",
    "simpleradialfisheye",
    "radialfisheye",
    "equidistant",
    "equi",
    "pinholeequi",
    "pinholeequidistant",
    "kannalabrandt",
    "kannalabrandt4",
    "kannalabrandt8",
    "kb",
    "kb4",
    "kb8",
];
/// Names of other models, whatever the key is.
const OTHER_NAMES: &[&str] = &[
    "thinprismfisheye",
    "equirectangular",
    "omnidirectional",
    "omnidir",
    "omni",
    "unified",
    "eucm",
    "doublesphere",
    "spherical",
    "panoramic",
    "orthographic",
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
/// Coefficients by name in the order of OpenCV's model, and in that of its fisheye.
const OPENCV: [&str; 12] = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4"];
const FISHEYE: [&str; 4] = ["k1", "k2", "k3", "k4"];
/// All coefficients that are read by name. Those beyond OpenCV's must be zero.
pub const NAMED: &[&str] =
    &["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "p3", "p4", "tau_x", "tau_y", "b1", "b2"];

/// Lower-case letters and digits of a name, so that spellings of the same name agree.
pub fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The model that the keys of an object name, if they do. A lens of another kind is an error.
pub fn model(object: &Map<String, Value>) -> Result<Option<LensModel>, String> {
    let mut found: Option<(LensModel, &str, bool)> = None;
    for (key, value) in object {
        let Some(named) = named_by(key, value)? else { continue };
        // A pinhole may have the fisheye's distortion.
        let loose = value.as_str().is_some_and(|words| PROJECTIONS.contains(&plain(words).as_str()));
        match found {
            Some((other, by, false)) if other != named && !loose => {
                return Err(format!("`{by}` and `{key}` name different lenses: remove the one that is wrong"));
            }
            Some((_, _, was_loose)) if loose || !was_loose => {}
            _ => found = Some((named, key, loose)),
        }
    }
    Ok(found.map(|(model, ..)| model))
}

/// The model that a key and its value name, if they do.
pub fn named_by(key: &str, value: &Value) -> Result<Option<LensModel>, String> {
    if is_neutral(value) {
        return Ok(None);
    }
    let name = plain(key);
    let is_flag = *value == Value::Bool(true)
        || *value == 1
        || value.as_str().is_some_and(|text| ["1", "true", "yes", "on"].contains(&text.trim().to_lowercase().as_str()));
    if name.contains("fish") && is_flag {
        return Ok(Some(LensModel::Fisheye));
    }
    let words = value.as_str().map(plain);
    if OTHER_KEYS.iter().any(|part| name.contains(part)) || name == "xi" {
        // A key such as `fisheye` whose value is the name of a model.
        if words.as_deref().is_some_and(|words| FISHEYES.contains(&words)) {
            return Ok(Some(LensModel::Fisheye));
        }
        return Err(format!("`{key}` belongs to a lens that a scene cannot hold: {REMEDY}"));
    }
    if let Value::Object(inner) = value {
        return model(inner).map_err(|problem| format!("{key}: {problem}"));
    }
    let is_model_key = MODEL_KEYS.contains(&key);
    let vague = ["type", "cameratype"].contains(&name.as_str())
        || ["model", "lens", "projection"].iter().any(|p| name.contains(p));
    // Flags of OpenCV's functions name the model by their namespace: fisheye::CALIB_FIX_SKEW.
    let flags_of = |space: &str| value.as_str().is_some_and(|text| text.contains(space));
    let found = match words.as_deref() {
        Some(_) if flags_of("fisheye::") => Some(Ok(LensModel::Fisheye)),
        Some(words) if FISHEYES.contains(&words) && !NAMES_OF_FILES.contains(&key) => Some(Ok(LensModel::Fisheye)),
        Some(words) if is_model_key => Some(MODELS.contains(&words).then_some(LensModel::OpenCv).ok_or(())),
        Some(words) => {
            let other = OTHER_NAMES.contains(&words) && !NAMES_OF_FILES.contains(&key)
                || flags_of("omnidir::")
                || vague && OTHER_MODELS.iter().any(|part| words.contains(part));
            other.then_some(Err(()))
        }
        None => is_model_key.then_some(Err(())),
    };
    found.transpose().map_err(|()| format!("{key} {value} is not supported: {REMEDY}"))
}

/// The model of a camera. What its own keys name has precedence over what those of all cameras do.
pub fn of_levels(levels: &Levels) -> Result<Option<LensModel>, String> {
    for object in &levels.0 {
        if let Some(model) = model(object)? {
            return Ok(Some(model));
        }
    }
    Ok(None)
}

/// The lens of a model without coefficients.
pub fn plainest(model: Option<LensModel>) -> Lens {
    match model {
        Some(LensModel::Fisheye) => Lens::Fisheye([0.0; 4]),
        _ => Lens::NONE,
    }
}

/// Distortion from OpenCV's list k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tau_x tau_y, or k1 k2 k3 k4 of its fisheye.
pub fn from_list(key: &str, list: &[f64], model: Option<LensModel>) -> Result<Lens, String> {
    if list.iter().all(|&v| v == 0.0) {
        return Ok(plainest(model));
    }
    if list.len() == 3 {
        return Err(format!("{key} has 3 numbers, but OpenCV's model has 4, 5, 8 or 12: write k1 k2 p1 p2 k3"));
    }
    lens::read(model.unwrap_or_default(), list).map_err(|problem| format!("{key} {problem}, or {REMEDY}"))
}

/// Distortion from coefficients by name. None if there are none.
pub fn from_names(levels: &Levels, model: Option<LensModel>) -> Result<Option<Lens>, String> {
    let is_fisheye = model == Some(LensModel::Fisheye);
    let order: &[&str] = if is_fisheye { &FISHEYE } else { &OPENCV };
    for object in &levels.0 {
        for &name in NAMED.iter().filter(|name| !order.contains(name)) {
            if let Some((key, value)) = find(object, &[name])
                && number(&key, value)? != 0.0
            {
                let of = if is_fisheye { "fisheye" } else { "lens" };
                return Err(format!("the {of} has the coefficient {name} = {value}, which is not supported: {REMEDY}"));
            }
        }
    }
    let found: Vec<Option<f64>> = order.iter().map(|&name| levels.number(&[name])).collect::<Result<_, _>>()?;
    if found.iter().all(Option::is_none) {
        return Ok(None);
    }
    let at = |i: usize| found[i].unwrap_or(0.0);
    if is_fisheye {
        return Ok(Some(Lens::Fisheye(std::array::from_fn(at))));
    }
    // Without k5 and k6 it may also be that of a fisheye, or of the eighth power of the radius.
    if at(5) != 0.0 && found[6].or(found[7]).is_none() {
        return Err(format!(
            "k4 = {} is ambiguous: add k5 and k6 if they are those of OpenCV's rational model, name the model if the lens is \
             a fisheye (`distortion_model` or `camera_model` with the value `fisheye`), or else {REMEDY}",
            at(5)
        ));
    }
    Ok(Some(Lens::OpenCv(std::array::from_fn(at))))
}
