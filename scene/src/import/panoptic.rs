//! CMU Panoptic's calibration JSON: a list `cameras` with K, distCoef (k1 k2 p1 p2 k3), R and t, world to camera as in a
//! scene, in centimetres. The file describes hundreds of cameras; those without a picture are left out.

use super::{
    found::{Found, pictures},
    json,
    keys::{listed, unread},
    lens,
    notes::Notes,
    source::{failure, read_text},
    values::{self, Levels, numbers, text, to_array},
    video_names,
    view::{ImportedView, rows},
};
use crate::{failure::Failure, files::Files};
use serde_json::{Map, Value};
use std::path::Path;

const KEYS: &[&str] = &["name", "K", "distCoef", "R", "t", "resolution"];
/// The place of a camera in the dome.
const PLACES: &[&str] = &["type", "panel", "node"];
/// Folders with pictures or videos. The pictures of VGA and HD cameras have a folder each.
const FOLDERS: [&str; 7] = ["", "images", "hdImgs", "vgaImgs", "kinectImgs", "hdVideos", "vgaVideos"];

/// Whether a JSON file is of this format.
pub fn is_panoptic(value: &Value) -> bool {
    value.get("cameras").and_then(|list| list.get(0)).is_some_and(|camera| camera.get("distCoef").is_some())
}

/// Reads the file.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
    let value = json::parse(&read_text(files, path)?).map_err(wrong)?;
    let cameras = value.get("cameras").and_then(Value::as_array);
    let cameras = cameras.ok_or_else(|| wrong(String::from("has no list `cameras`: name a calibration_*.json")))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let folders = FOLDERS.map(|name| folder.join(name));
    let beside = value.as_object().into_iter().flatten().filter(|(key, _)| *key != "cameras");
    let top: Map<String, Value> = beside.map(|(key, value)| (key.clone(), value.clone())).collect();
    lens::model(&top).map_err(wrong)?;
    unread(&top, &[], &[]).map_err(wrong)?;
    let mut views = Vec::new();
    let mut without = Vec::new();
    for (i, keys) in cameras.iter().enumerate() {
        let keys = keys.as_object().ok_or_else(|| wrong(format!("cameras[{i}] is not an object: correct it")))?;
        let name = keys.get("name").and_then(text).ok_or_else(|| wrong(format!("cameras[{i}] has no name: add it")))?;
        let has_video = || video_names::find(files, &folders, &[&name]).map_or(true, |video| video.is_some());
        if pictures(files, &folders, &name)?.is_empty() && !has_video() {
            without.push(name);
            continue;
        }
        let of_camera = |problem: String| failure(path, &name, &problem);
        let ignored = unread(keys, &[KEYS, PLACES], &[]).map_err(of_camera)?;
        if !ignored.is_empty() {
            notes.add(format!("{}: ignored: {}", path.display(), listed(ignored)));
        }
        views.extend(camera(&name, &Levels(vec![keys, &top])).map_err(of_camera)?.views(files, path, &folders, notes)?);
    }
    if views.is_empty() {
        return Err(wrong(String::from("none of its cameras has a picture: put them in `images` or hdImgs/NAME")));
    }
    if !without.is_empty() {
        notes.add(format!(
            "{}: {} of {} cameras have no picture and are left out, such as {}",
            path.display(),
            without.len(),
            cameras.len(),
            listed(without.iter().take(3).map(String::as_str))
        ));
    }
    Ok(views)
}

/// A camera from its own keys, and those of all cameras.
fn camera(name: &str, levels: &Levels) -> Result<Found, String> {
    let keys = levels.0[0];
    let list = |key: &str| -> Result<Vec<f64>, String> {
        let value = keys.get(key).ok_or_else(|| format!("`{key}` is missing: add it"))?;
        numbers(value).map_err(|problem| format!("{key}: {problem}"))
    };
    let size = match keys.get("resolution") {
        Some(_) => {
            let [width, height] = to_array(&list("resolution")?, "resolution")?;
            Some(values::size(width, height)?)
        }
        None => None,
    };
    Ok(Found {
        name: name.to_owned(),
        picture: name.to_owned(),
        size,
        k: to_array(&list("K")?, "K").map(rows)?,
        lens: lens::from_list("distCoef", &list("distCoef")?, lens::of_levels(levels)?)?,
        r: to_array(&list("R")?, "R").map(rows)?,
        t: to_array(&list("t")?, "t")?,
    })
}
