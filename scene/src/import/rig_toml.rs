//! The TOML files of anipose, FreeMoCap and Caliscope: a table per camera with `matrix`, `distortions`, `rotation`
//! (Rodrigues' vector or a matrix) and `translation`, world to camera as in OpenCV, and `size`. The cameras' videos may be
//! listed in `videos`, in the order of the tables.

use super::{
    found::Found,
    keys::{listed, unread},
    lens,
    notes::Notes,
    source::{failure, is_video, read_text},
    values::{self, Levels, is_neutral, numbers, text, to_array},
    view::{ImportedView, rotation, rows},
};
use crate::{failure::Failure, files::Files};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

const K: &str = "matrix";
const KEYS: &[&str] = &[
    "name",
    "size",
    K,
    "distortions",
    "rotation",
    "translation",
    "rotation_count",
    "fisheye",
    "ignore",
    "cam_id",
    "port",
];
/// What FreeMoCap derives from rotation and translation.
const HARMLESS: &[&str] = &["world_position", "world_orientation"];

/// Folders beside the file, in which these programs keep videos.
const FOLDERS: [&str; 3] = ["images", "videos", "synchronized_videos"];
const VIDEOS: &str = "videos";

type Object = Map<String, Value>;

/// Reads the file.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
    let top: Object = toml::from_str(&read_text(files, path)?).map_err(|e| wrong(format!("{e}: correct that line")))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let folders: Vec<PathBuf> =
        std::iter::once(folder.to_path_buf()).chain(FOLDERS.map(|name| folder.join(name))).collect();
    let cameras = cameras(&top);
    let videos = videos(&top, cameras.len()).map_err(wrong)?;
    let mut views = Vec::new();
    for (i, (table, keys)) in cameras.into_iter().enumerate() {
        let name = keys.get("name").and_then(text).unwrap_or_else(|| table.clone());
        let of_camera = |problem: String| failure(path, &name, &problem);
        if keys.get("ignore").is_some_and(|value| !is_neutral(value)) {
            notes.add(format!("camera `{name}`: {}: is marked `ignore` and left out", path.display()));
            continue;
        }
        let ignored = unread(keys, &[KEYS], HARMLESS).map_err(of_camera)?;
        if !ignored.is_empty() {
            notes.add(format!("{}: ignored of every camera: {}", path.display(), listed(ignored)));
        }
        let mut found = camera(&name, keys).map_err(of_camera)?;
        if let Some(videos) = &videos {
            found.picture.clone_from(&videos[i]);
        }
        views.extend(found.views(files, path, &folders, notes)?);
    }
    if views.is_empty() {
        return Err(wrong(format!("contains no camera: a table with `{K}` is needed")));
    }
    Ok(views)
}

/// The tables with a camera: of the file, or of its table `cameras`.
fn cameras(top: &Object) -> Vec<(&String, &Object)> {
    let below = top.get("cameras").and_then(Value::as_object).into_iter().flatten();
    let tables = top.iter().chain(below).filter_map(|(name, value)| Some((name, value.as_object()?)));
    tables.filter(|(_, keys)| ["matrix", "rotation", "distortions"].iter().any(|key| keys.contains_key(*key))).collect()
}

/// The videos of the cameras, if they are listed, at the top or in `metadata`.
fn videos(top: &Object, count: usize) -> Result<Option<Vec<String>>, String> {
    let listed = top.get(VIDEOS).or_else(|| top.get("metadata")?.get(VIDEOS));
    let Some(listed) = listed else { return Ok(None) };
    let names = listed.as_array().map(|list| list.iter().filter_map(text).collect::<Vec<_>>()).unwrap_or_default();
    if names.len() == count && names.iter().all(|name| is_video(Path::new(name))) {
        return Ok(Some(names));
    }
    Err(format!("{VIDEOS}: list one video for each of the {count} cameras, in the order of their tables"))
}

fn camera(name: &str, keys: &Object) -> Result<Found, String> {
    let list = |key: &str| -> Result<Vec<f64>, String> {
        let value = keys.get(key).ok_or_else(|| format!("`{key}` is missing: calibrate this camera, or remove it"))?;
        numbers(value).map_err(|problem| format!("{key}: {problem}"))
    };
    if keys.get("rotation_count").is_some_and(|value| !is_neutral(value)) {
        return Err(String::from(
            "rotation_count says that its pictures are turned: turn them, and the calibration with them, or calibrate with \
             rotation_count = 0",
        ));
    }
    let model = lens::of_levels(&Levels(vec![keys]))?;
    let [width, height] = to_array(&list("size")?, "size")?;
    Ok(Found {
        name: name.to_owned(),
        picture: name.to_owned(),
        size: Some(values::size(width, height)?),
        k: to_array(&list(K)?, K).map(rows)?,
        lens: lens::from_list("distortions", &list("distortions")?, model)?,
        r: rotation(&list("rotation")?)?,
        t: to_array(&list("translation")?, "translation")?,
    })
}
