//! OpenCV calibrations in YAML or JSON, as FileStorage writes them. World to camera and the centre of the first pixel
//! follow the convention of a scene.
//!
//! A file contains one camera, or several as a list or map `cameras` or as named maps. Keys beside the cameras apply to
//! all of them. A folder contains one file per camera. Of the keys below, the first that exists is used:
//! - K: `camera_matrix`, `cameraMatrix`, `K`, `intrinsic_matrix`, `mtx`
//! - distortion k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, or k1 k2 k3 k4 if a key says that the lens is a fisheye:
//!   `distortion_coefficients`, `distCoeffs`, `dist_coeffs`, `D`, `distortion`, or each by its name; default: zero
//! - rotation, as a 3x3 matrix or Rodrigues' vector: `R`, `rotation_matrix`, `rotation`, `rvec`,
//!   `rotation_vector`
//! - translation: `t`, `tvec`, `T`, `translation`, `translation_vector`
//! - size: `image_width` and `image_height`, `width` and `height`, or `image_size`; default: the size of the picture
//! - name: `name`; default: the key in the map, or the stem of the file
//! - picture: `image`, `image_path`, `file`; default: a picture with the camera's name, in this folder or in `images`, or a
//!   folder of that name with one per instant
//! - mask: `mask`, `mask_path`; default: searched for in `masks`

use super::{
    found::Found,
    keys::{listed, unread},
    lens,
    notes::Notes,
    opencv_storage,
    source::{failure, find_picture},
    values::{self, Levels, find, numbers, text, to_array},
    view::{ImportedView, rotation, rows},
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::Lens;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

const K: &[&str] = &["camera_matrix", "cameraMatrix", "K", "intrinsic_matrix", "mtx"];
const DISTORTION: &[&str] =
    &["distortion_coefficients", "distCoeffs", "dist_coeffs", "distortion_coeffs", "D", "distortion", "dist"];
const ROTATION: &[&str] = &["R", "rotation_matrix", "rotation", "rvec", "rotation_vector"];
const TRANSLATION: &[&str] = &["t", "tvec", "T", "translation", "translation_vector"];
const SIZES: [[&str; 2]; 2] = [["image_width", "image_height"], ["width", "height"]];
const SIZE: &[&str] = &["image_size"];
const SIZE_PARTS: &[&str] = &["image_width", "image_height", "width", "height"];
const NAME: &[&str] = &["name"];
const IMAGE: &[&str] = &["image", "image_path", "file"];
const MASK: &[&str] = &["mask", "mask_path"];
/// Keys that look like calibration but do not change it: OpenCV's and ROS' tools write them beside the calibration.
const HARMLESS: &[&str] = &[
    "extrinsic_parameters",
    "projection_matrix",
    "rectification_matrix",
    "std_deviations_intrinsics",
    "std_deviations_extrinsics",
];

type Object = Map<String, Value>;

/// Reads a file, or all YAML and JSON files of a folder that contain a camera.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let mut views = Vec::new();
    for file in calibrations(files, path)? {
        let value = opencv_storage::read(files, &file)?;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
        let contents = Contents::new(&value, stem).map_err(wrong)?;
        if contents.cameras.is_empty() {
            let parts = [DISTORTION, ROTATION, TRANSLATION];
            let part = value.as_object().and_then(|top| parts.iter().find_map(|keys| find(top, keys)));
            if let Some((key, _)) = part {
                return Err(wrong(format!("has `{key}`, but none of the keys {K:?}: add K, or move the file away")));
            }
            notes.add(format!("{}: contains no camera and is ignored", file.display()));
            continue;
        }
        contents.check_shared(&file, notes).map_err(wrong)?;
        for (name, own) in &contents.cameras {
            views.extend(camera(files, &file, name, own, &contents.shared, notes)?);
        }
    }
    if views.is_empty() {
        return Err(Failure::Input(format!("{}: contains no camera: one of the keys {K:?} is needed", path.display())));
    }
    Ok(views)
}

fn calibrations(files: &dyn Files, path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !files.is_folder(path) {
        return Ok(vec![path.to_path_buf()]);
    }
    let known = |file: &PathBuf| {
        file.extension().is_some_and(|e| ["yml", "yaml", "json"].iter().any(|known| e.eq_ignore_ascii_case(known)))
    };
    let entries = files.list(path).map_err(|e| Failure::unreadable(path, &e))?;
    Ok(entries.into_iter().filter(known).collect())
}

/// The cameras of a file, with their names, and the keys beside them.
struct Contents<'a> {
    cameras: Vec<(String, &'a Object)>,
    shared: Object,
}

impl<'a> Contents<'a> {
    fn new(value: &'a Value, stem: String) -> Result<Self, String> {
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

    fn check_shared(&self, file: &Path, notes: &mut Notes) -> Result<(), String> {
        lens::model(&self.shared)?;
        // One pose for all cameras would put them into the same place: it means something else, such as a stereo pair's.
        for keys in [ROTATION, TRANSLATION] {
            if let Some((key, _)) = find(&self.shared, keys) {
                return Err(format!(
                    "`{key}` stands beside the cameras: give every camera its own pose, world to camera"
                ));
            }
        }
        note_unread(&self.shared, file, notes)
    }
}

fn note_unread(object: &Object, file: &Path, notes: &mut Notes) -> Result<(), String> {
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

/// The views of a camera: one per picture.
fn camera(
    files: &dyn Files,
    file: &Path,
    name: &str,
    own: &Object,
    shared: &Object,
    notes: &mut Notes,
) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| failure(file, name, &problem);
    lens::model(own).map_err(wrong)?;
    note_unread(own, file, notes).map_err(wrong)?;
    let levels = Levels(vec![own, shared]);
    let folder = file.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_path_buf(), folder.join("images")];
    let path = |keys: &[&str]| -> Result<Option<String>, Failure> {
        let Some((key, value)) = find(own, keys) else { return Ok(None) };
        text(value).map(Some).ok_or_else(|| wrong(format!("{key} is not a path")))
    };
    let picture = path(IMAGE)?.unwrap_or_else(|| name.to_owned());
    let mask = match path(MASK)? {
        Some(mask) => Some(find_picture(files, &folders[..1], &mask).ok_or_else(|| {
            wrong(format!(
                "its mask `{mask}` is missing: correct the key `mask`, or remove it and put the mask in `masks`"
            ))
        })?),
        None => None,
    };
    let k = required(&levels, K).and_then(|n| to_array(&n, "K")).map_err(wrong)?;
    let t = required(&Levels(vec![own]), TRANSLATION).and_then(|n| to_array(&n, "t")).map_err(wrong)?;
    let found = Found {
        name: name.to_owned(),
        picture,
        size: size(&levels).map_err(wrong)?,
        k: rows(k),
        lens: distortion(&levels).map_err(wrong)?,
        r: required(&Levels(vec![own]), ROTATION).and_then(|n| rotation(&n)).map_err(wrong)?,
        t,
    };
    let mut views = found.views(files, file, &folders, notes)?;
    if mask.is_some() && views.len() > 1 {
        return Err(wrong(String::from(
            "has one mask for several pictures: remove the key `mask`, and put masks in `masks`",
        )));
    }
    for view in &mut views {
        view.mask = mask.clone();
    }
    Ok(views)
}

fn required(levels: &Levels, keys: &[&str]) -> Result<Vec<f64>, String> {
    let (key, found) = levels.find(keys).ok_or_else(|| format!("one of {keys:?} is needed"))?;
    numbers(found).map_err(|problem| format!("{key}: {problem}"))
}

fn size(levels: &Levels) -> Result<Option<[u32; 2]>, String> {
    for [width, height] in SIZES {
        match (levels.number(&[width])?, levels.number(&[height])?) {
            (Some(w), Some(h)) => return values::size(w, h).map(Some),
            (None, None) => {}
            _ => return Err(format!("{width} and {height} are needed together: add the other, or remove both")),
        }
    }
    let Some((key, pair)) = levels.find(SIZE) else { return Ok(None) };
    let [w, h] = numbers(pair).and_then(|n| to_array(&n, &key))?;
    values::size(w, h).map(Some)
}

fn distortion(levels: &Levels) -> Result<Lens, String> {
    let model = lens::of_levels(levels)?;
    let named = lens::from_names(levels, model)?;
    let Some((key, found)) = levels.find(DISTORTION) else { return Ok(named.unwrap_or(lens::plainest(model))) };
    let listed =
        numbers(found).map_err(|problem| format!("{key}: {problem}")).and_then(|n| lens::from_list(&key, &n, model))?;
    match named {
        Some(named) if named != listed => {
            Err(format!("{key} and the coefficients by name contradict each other: remove those that are wrong"))
        }
        _ => Ok(listed),
    }
}
