//! The TOML files of anipose, FreeMoCap and Caliscope: a table per camera with `matrix`, `distortions`, `rotation`
//! (Rodrigues' vector or a matrix) and `translation`, world to camera as in OpenCV, and `size`. The cameras' videos may be
//! listed in `videos`, in the order of the tables. Otherwise the name of a video contains that of its camera.

use super::{
    found::{Found, pictures},
    keys::{listed, unread},
    lens,
    notes::Notes,
    source::{failure, is_video, read_text},
    values::{self, Levels, is_neutral, numbers, text, to_array},
    video_names,
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
/// A table about the calibration itself.
const METADATA: &str = "metadata";

type Object = Map<String, Value>;

/// Reads the file.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
    let top: Object = toml::from_str(&read_text(files, path)?).map_err(|e| wrong(format!("{e}: correct that line")))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let folders: Vec<PathBuf> =
        std::iter::once(folder.to_path_buf()).chain(FOLDERS.map(|name| folder.join(name))).collect();
    let cameras = cameras(&top).map_err(wrong)?;
    let videos = videos(&top, cameras.len()).map_err(wrong)?;
    let shared = shared(&top);
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
        let mut found = camera(&name, &Levels(vec![keys, &shared])).map_err(of_camera)?;
        if let Some(videos) = &videos {
            found.picture.clone_from(&videos[i]);
        } else if pictures(files, &folders, &name)?.is_empty() {
            let numbers = ["port", "cam_id"].map(|key| keys.get(key).and_then(text));
            let other =
                |(word, number): (&str, &Option<String>)| number.as_ref().map(|number| format!("{word}_{number}"));
            let others: Vec<String> = ["port", "cam"].into_iter().zip(&numbers).filter_map(other).collect();
            let names: Vec<&str> = [&name, table].into_iter().chain(&others).map(String::as_str).collect();
            let video = video_names::find(files, &folders, &names);
            let list = |problem: String| {
                let all =
                    "or list the videos of all cameras, in the order of their tables, as `videos = [\"a.mp4\", ...]`";
                of_camera(format!("{problem}, {all} at the top of the file"))
            };
            if let Some(video) = video.map_err(list)? {
                video.note(&name, notes);
                let path = video.path.strip_prefix(folder).unwrap_or(&video.path);
                found.picture = path.to_string_lossy().into_owned();
            }
        }
        views.extend(found.views(files, path, &folders, notes)?);
    }
    if views.is_empty() {
        return Err(wrong(format!("contains no camera: a table with `{K}` is needed")));
    }
    Ok(views)
}

/// The tables with a camera: of the file, or of its table `cameras`. Other tables must not look like a calibration.
fn cameras(top: &Object) -> Result<Vec<(&String, &Object)>, String> {
    let below = top.get("cameras").and_then(Value::as_object).into_iter().flatten();
    let tables = top.iter().filter(|(name, _)| ![METADATA, "cameras"].contains(&name.as_str())).chain(below);
    let mut cameras = Vec::new();
    for (name, table) in tables.filter_map(|(name, value)| Some((name, value.as_object()?))) {
        if ["matrix", "rotation", "translation", "distortions", "size"].iter().any(|key| table.contains_key(*key)) {
            cameras.push((name, table));
        } else {
            unread(table, &[], &[]).map_err(|problem| format!("table `{name}`: {problem}"))?;
        }
    }
    Ok(cameras)
}

/// The keys that apply to all cameras: those outside tables, and those of the table `metadata`.
fn shared(top: &Object) -> Object {
    let metadata = top.get(METADATA).and_then(Value::as_object);
    let keys = top.iter().chain(metadata.into_iter().flatten()).filter(|(_, value)| !value.is_object());
    keys.map(|(key, value)| (key.clone(), value.clone())).collect()
}

/// The videos of the cameras, if they are listed, at the top or in `metadata`.
fn videos(top: &Object, count: usize) -> Result<Option<Vec<String>>, String> {
    let listed = top.get(VIDEOS).or_else(|| top.get(METADATA)?.get(VIDEOS));
    let Some(listed) = listed else { return Ok(None) };
    let names = listed.as_array().map(|list| list.iter().filter_map(text).collect::<Vec<_>>()).unwrap_or_default();
    if names.len() == count && names.iter().all(|name| is_video(Path::new(name))) {
        return Ok(Some(names));
    }
    Err(format!("{VIDEOS}: list one video for each of the {count} cameras, in the order of their tables"))
}

/// A camera from its own keys, and those of all cameras.
fn camera(name: &str, levels: &Levels) -> Result<Found, String> {
    let keys = levels.0[0];
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
    let model = lens::of_levels(levels)?;
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
