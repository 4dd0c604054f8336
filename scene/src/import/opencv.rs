//! OpenCV calibrations in YAML, JSON or XML, as FileStorage writes them. World to camera and the centre of the first pixel
//! follow the convention of a scene.
//!
//! A file contains one camera, or several as a list or map `cameras` or as named maps. Keys beside the cameras apply to
//! all of them. A folder contains one file per camera. Of the keys below, the first that exists is used. Letter case and
//! underscores do not matter in those with more than two letters.
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
    values::{self, Levels, find, number, numbers, text, to_array},
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

/// Reads a file, or all YAML, JSON and XML files of a folder that contain a camera.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let mut views = Vec::new();
    for file in calibrations(files, path)? {
        let value = spelled(opencv_storage::read(files, &file)?);
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
        let contents = Contents::new(&value, stem).map_err(wrong)?;
        if contents.cameras.is_empty() {
            let top = value.as_object();
            check_pair(top).map_err(wrong)?;
            let parts = [DISTORTION, ROTATION, TRANSLATION];
            if let Some((key, _)) = top.and_then(|top| parts.iter().find_map(|keys| find(top, keys))) {
                return Err(wrong(format!("has `{key}`, but none of the keys {K:?}: add K, or move the file away")));
            }
            for keys in top.into_iter().chain(top.into_iter().flat_map(Map::values).filter_map(as_map)) {
                unread(keys, &[], HARMLESS).map_err(wrong)?;
                check_matrices(keys).map_err(wrong)?;
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
    let has = |file: &Path, ends: &[&str]| {
        file.extension().is_some_and(|e| ends.iter().any(|known| e.eq_ignore_ascii_case(known)))
    };
    let known = |file: &PathBuf| {
        has(file, &["yml", "yaml", "json"]) || has(file, &["xml"]) && opencv_storage::is_xml(files, file)
    };
    let entries = files.list(path).map_err(|e| Failure::unreadable(path, &e))?;
    Ok(entries.into_iter().filter(known).collect())
}

/// Whether a file has a camera, and nothing else is known of it.
pub fn is_camera_file(files: &dyn Files, file: &Path) -> bool {
    let Ok(value) = opencv_storage::read(files, file) else { return false };
    Contents::new(&spelled(value), String::new()).is_ok_and(|contents| !contents.cameras.is_empty())
}

/// The same values, where keys of the file and of its maps that are known in another letter case or with other underscores,
/// such as `Camera_Matrix`, have the known spelling. Short keys differ by their case (`t` and `T`), and those of maps may be
/// names of cameras. Where a key has two spellings, one stays and is refused later.
fn spelled(value: Value) -> Value {
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

/// Refuses the files of a stereo pair, which have one pose for two cameras.
fn check_pair(top: Option<&Object>) -> Result<(), String> {
    let numbered = ["M", "K", "cameraMatrix", "camera_matrix", "CM"].map(|key| [format!("{key}1"), format!("{key}2")]);
    match top.and_then(|top| numbered.iter().find(|pair| pair.iter().all(|key| top.contains_key(key)))) {
        Some([first, second]) => Err(format!(
            "has two cameras, `{first}` and `{second}`, of a stereo pair, whose R and t lead from one to the other: write one \
             camera per file or per map, each with its own pose, world to camera"
        )),
        None => Ok(()),
    }
}

/// A map that is not a matrix.
fn as_map(value: &Value) -> Option<&Object> {
    value.as_object().filter(|map| !map.contains_key("data"))
}

/// Refuses keys that hold a matrix with 3 or 4 rows and columns: what is not understood may be a camera.
fn check_matrices(keys: &Object) -> Result<(), String> {
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
        for (name, keys) in self.shared.iter().filter_map(|(name, value)| Some((name, as_map(value)?))) {
            let of_map = |problem| format!("{name}: {problem}");
            unread(keys, &[], HARMLESS).map_err(of_map)?;
            check_matrices(keys).map_err(of_map)?;
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
