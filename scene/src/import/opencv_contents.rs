//! The cameras in a calibration of OpenCV.

use super::{
    keys::{listed, unread},
    lens,
    notes::Notes,
    opencv_keys::{
        DISTORTION, HARMLESS, IMAGE, K, MASK, NAME, Object, ROTATION, SIZE, SIZE_PARTS, TRANSLATION, as_map,
        check_matrices,
    },
    values::{find, text},
};
use serde_json::Value;
use std::path::Path;

/// Whether a calibration has a camera.
pub fn has_camera(value: &Value) -> bool {
    Contents::new(value, String::new()).is_ok_and(|contents| !contents.cameras.is_empty())
}

/// The cameras of a file, with their names, and the keys beside them.
pub struct Contents<'a> {
    pub cameras: Vec<(String, &'a Object)>,
    pub shared: Object,
}

impl<'a> Contents<'a> {
    pub fn new(value: &'a Value, stem: String) -> Result<Self, String> {
        let named = |camera: &Object, otherwise: String| camera.get("name").and_then(text).unwrap_or(otherwise);
        let object = |name: &str, value: &'a Value| {
            value.as_object().ok_or_else(|| format!("camera `{name}` is not a map of keys and values"))
        };
        if let Some(list) = value.as_array() {
            return Self::list(list, Object::new());
        }
        let Some(top) = value.as_object() else { return Ok(Self { cameras: Vec::new(), shared: Object::new() }) };
        let beside = |skipped: &dyn Fn(&str, &Value) -> bool| -> Object {
            top.iter().filter(|(key, value)| !skipped(key, value)).map(|(k, v)| (k.clone(), v.clone())).collect()
        };
        match top.get("cameras") {
            Some(Value::Array(list)) => return Self::list(list, beside(&|key, _| key == "cameras")),
            Some(Value::Object(map)) => {
                let cameras: Result<Vec<_>, String> = map
                    .iter()
                    .map(|(key, camera)| object(key, camera).map(|camera| (named(camera, key.clone()), camera)))
                    .collect();
                return Ok(Self { cameras: cameras?, shared: beside(&|key, _| key == "cameras") });
            }
            _ => {}
        }
        let is_camera = |value: &Value| {
            value.as_object().is_some_and(|o| [K, ROTATION, TRANSLATION].iter().any(|keys| find(o, keys).is_some()))
        };
        let entries =
            top.iter().filter_map(|(key, value)| Some((key, value.as_object().filter(|_| is_camera(value))?)));
        let cameras: Vec<_> = entries.map(|(key, camera)| (named(camera, key.clone()), camera)).collect();
        if !cameras.is_empty() {
            return Ok(Self { cameras, shared: beside(&|_, value| is_camera(value)) });
        }
        let single = find(top, K).is_some().then(|| (named(top, stem), top));
        Ok(Self { cameras: single.into_iter().collect(), shared: Object::new() })
    }

    fn list(list: &'a [Value], shared: Object) -> Result<Self, String> {
        let camera = |(i, value): (usize, &'a Value)| {
            let camera = value.as_object().ok_or_else(|| format!("camera {i} is not a map of keys and values"))?;
            Ok((camera.get("name").and_then(text).unwrap_or_else(|| format!("cam{i:02}")), camera))
        };
        Ok(Self { cameras: list.iter().enumerate().map(camera).collect::<Result<_, String>>()?, shared })
    }

    pub fn check_shared(&self, file: &Path, notes: &mut Notes) -> Result<(), String> {
        lens::model(&self.shared)?;
        // One pose for all cameras would put them into the same place: it means something else, such as a stereo pair's.
        for keys in [ROTATION, TRANSLATION] {
            if let Some((key, _)) = find(&self.shared, keys) {
                return Err(format!(
                    "`{key}` stands beside the cameras: give every camera its own pose, world to camera"
                ));
            }
        }
        for (name, keys) in self.shared.iter().filter_map(|(name, value)| Some((name, as_map(value)?))) {
            let of_map = |problem| format!("{name}: {problem}");
            unread(keys, &[], HARMLESS).map_err(of_map)?;
            check_matrices(keys).map_err(of_map)?;
        }
        note_unread(&self.shared, file, notes)
    }
}

/// Notes the keys that are not read. Those that look like calibration are an error.
pub fn note_unread(object: &Object, file: &Path, notes: &mut Notes) -> Result<(), String> {
    let sizes = [SIZE, SIZE_PARTS];
    let own = [K, DISTORTION, ROTATION, TRANSLATION, NAME, IMAGE, MASK, lens::NAMED, lens::MODEL_KEYS];
    let understood: Vec<&[&str]> = own.into_iter().chain(sizes).collect();
    let ignored = unread(object, &understood, HARMLESS)?;
    if !ignored.is_empty() {
        notes.add(format!("{}: ignored: {}", file.display(), listed(ignored)));
    }
    for keys in [K, DISTORTION, ROTATION, TRANSLATION] {
        let present: Vec<&str> =
            keys.iter().copied().filter(|&key| object.get(key).is_some_and(|v| !v.is_null())).collect();
        if let [used, rest @ ..] = present.as_slice()
            && !rest.is_empty()
        {
            let rest = listed(rest.iter().copied());
            notes.add(format!("{}: `{used}` is used, and {rest} ignored", file.display()));
        }
    }
    Ok(())
}
