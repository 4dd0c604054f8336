//! Keys of a calibration file that no importer reads. Those that look like calibration are errors, so that nothing which
//! changes the geometry is lost; the others are named in a note.

use super::{
    lens::{self, plain},
    values::is_neutral,
};
use serde_json::{Map, Value};

/// Parts of keys that describe a lens. Zero means that there is nothing to describe.
const LENS: &[&str] = &[
    "distort",
    "distcoef",
    "distparam",
    "lensparam",
    "lenscoef",
    "fish",
    "omni",
    "radial",
    "tangential",
    "prism",
    "skew",
    "rollingshutter",
    "ftheta",
    "orthographic",
    "shift",
];
/// Parts of keys that describe the projection or the pose.
const GEOMETRY: &[&str] = &[
    "focal",
    "fov",
    "intrin",
    "extrin",
    "rotation",
    "rotmat",
    "translation",
    "transform",
    "pose",
    "matrix",
    "principal",
    "c2w",
    "w2c",
    "cam2world",
    "world2cam",
    "worldtocam",
    "camtoworld",
    "cameratoworld",
    "quaternion",
    "quat",
    "euler",
    "rodrigues",
    "rvec",
    "tvec",
    "convention",
    "coordinatesystem",
    "coordsystem",
    "coordinateframe",
    "isopencv",
    "isopengl",
    "pixelcentre",
    "pixelcenter",
    "pixelaspect",
];
/// Whole keys that describe the projection, the lens or the pose.
const WHOLE: &[&str] =
    &["r", "t", "rt", "k", "p", "c", "q", "d", "fx", "fy", "cx", "cy", "f", "rot", "trans", "crop", "dist"];
/// Parts of keys that tell of a convention if their value names one, and such values.
const OF_CONVENTIONS: &[&str] = &["axes", "axis", "coord", "orient", "system", "space"];
const CONVENTIONS: &[&str] =
    &["opencv", "opengl", "blender", "pytorch3d", "c2w", "w2c", "cam2world", "world2cam", "camtoworld", "worldtocam"];
/// Parts of keys that only resemble those above.
const OTHERS: &[&str] = &["exposure", "expose", "purpose"];

/// Lower-case letters and digits of a key, without the words that only resemble calibration.
fn words(key: &str) -> String {
    OTHERS.iter().fold(plain(key), |name, other| name.replace(other, ""))
}

/// Whether a key describes a lens.
fn is_of_lens(key: &str) -> bool {
    let name = words(key);
    let coefficient = name.strip_prefix(['k', 'p', 's']).is_some_and(|rest| rest.parse::<u8>().is_ok());
    coefficient || name == "xi" || name.starts_with("tau") || LENS.iter().any(|part| name.contains(part))
}

/// Whether a key that is not understood could change the geometry. Of the keys in a map, only those of a lens count: a
/// picture's metadata has a focal length in millimetres, too.
fn looks_like_calibration(key: &str, value: &Value) -> bool {
    if is_of_lens(key) {
        return !is_neutral(value);
    }
    let inner =
        value.as_object().is_some_and(|map| map.iter().any(|(key, value)| is_of_lens(key) && !is_neutral(value)));
    let name = words(key);
    let geometry = GEOMETRY.iter().any(|part| name.contains(part)) || WHOLE.contains(&name.as_str());
    let convention = value.as_str().is_some_and(|text| CONVENTIONS.contains(&plain(text).as_str()))
        && OF_CONVENTIONS.iter().any(|part| name.contains(part));
    inner || convention || geometry && !value.is_null()
}

/// The keys of an object that are neither understood nor harmless and do not look like calibration. A key that does look
/// like calibration is an error.
pub fn unread<'a>(
    object: &'a Map<String, Value>,
    understood: &[&[&str]],
    harmless: &[&str],
) -> Result<Vec<&'a str>, String> {
    let mut ignored = Vec::new();
    for (key, value) in object {
        let key = key.as_str();
        // An object may hold coefficients beside the name of its model.
        let names_model = || Ok::<bool, String>(lens::named_by(key, value)?.is_some() && !value.is_object());
        if understood.iter().any(|keys| keys.contains(&key)) || names_model()? {
            continue;
        }
        if !harmless.contains(&key) && looks_like_calibration(key, value) {
            return Err(format!(
                "the key `{key}` looks like calibration but is not understood: remove it if it does not matter, or convert \
                 it to a key that is"
            ));
        }
        // A lens without this kind of distortion needs no word.
        if !is_of_lens(key) {
            ignored.push(key);
        }
    }
    Ok(ignored)
}

/// Key names for a message.
pub fn listed<'a>(keys: impl IntoIterator<Item = &'a str>) -> String {
    keys.into_iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn keys_that_could_change_the_geometry_are_recognised() {
        let one = json!(1.5);
        for key in ["c2w", "camera_pose", "rot_matrix", "k7", "lens_params", "fov_x", "shift_x", "dist", "quat"] {
            let refused = unread(json!({ key: one }).as_object().unwrap(), &[], &[]).is_err();
            assert_eq!(refused, key != "{key}");
        }
        for key in
            ["exposure_time", "shutter_speed", "avg_reprojection_error", "distance", "aabb_scale", "serial", "comment"]
        {
            assert_eq!(unread(json!({ key: one }).as_object().unwrap(), &[], &[]), Ok(vec![key]));
        }
        let nothing = json!({ "k7": 0, "skew": 0.0, "is_fisheye": false, "fov": null });
        assert_eq!(unread(nothing.as_object().unwrap(), &[], &[]), Ok(vec!["fov"]));
        assert!(unread(json!({ "lens": { "k7": 0.1 } }).as_object().unwrap(), &[], &[]).is_err());
        let named = json!({ "lens": { "distortion_model": "plumb_bob", "k1": -0.2 } });
        assert!(unread(named.as_object().unwrap(), &[], &[]).is_err());
        assert!(unread(json!({ "exif": { "FocalLength": 35 } }).as_object().unwrap(), &[], &[]).is_ok());
    }
}
