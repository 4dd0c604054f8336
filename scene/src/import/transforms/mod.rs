//! NeRF's transforms.json (Blender, instant-ngp, nerfstudio, NerfCapture): camera to world with OpenGL's axes (x right,
//! y up, z backward). cx and cy count from the corner of the picture, so that the centre of the first pixel is at
//! (0.5, 0.5). A matrix K is OpenCV's, where that centre is at (0, 0).
//!
//! Every key of the projection may be given for all frames, or for a single one, which then takes precedence.

mod intrinsics;
mod pose;

use super::{
    json,
    keys::{listed, unread},
    lens,
    names::name_of,
    notes::Notes,
    source::{failure, find_picture, picture_size, read_text},
    values::{self, Levels, find, text},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::Camera;
use pose::Pose;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

const PICTURE: &[&str] = &["file_path"];
const MASK: &[&str] = &["mask_path"];
const POSE: &[&str] = &["transform_matrix"];
/// The time of a frame, which data sets of moving scenes have. Its unit differs.
const TIME: &[&str] = &["time", "time_id", "frame_time"];
/// Keys that look like calibration but do not change it. nerfstudio records what it did to the poses, which are used as
/// they are; NeRF's own data has the step of a turntable.
const HARMLESS: &[&str] = &["rotation", "applied_transform", "orientation_override", "share_intrinsics"];

/// Keys that say how a viewer moves the scene, or how it was moved already.
const OF_POSES: &[&str] =
    &["scale", "offset", "aabb_scale", "applied_transform", "applied_scale", "orientation_override"];

/// Reads transforms.json, or a folder that contains it or one other transforms_*.json.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let file = &file(files, path, notes)?;
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
    let text = read_text(files, file)?;
    let top = json::parse(&text).map_err(wrong)?;
    let top = top.as_object().ok_or_else(|| wrong(String::from("is not a JSON object: name a transforms.json")))?;
    let frames = top.get("frames").and_then(Value::as_array);
    let frames = frames.ok_or_else(|| wrong(String::from("has no list `frames`: name a transforms.json")))?;
    if let Some((key, count)) = find(top, &["n_frames"])
        && values::number(&key, count).map_err(wrong)? != frames.len() as f64
    {
        return Err(wrong(format!("announces {count} frames, but there are {}: copy the file again", frames.len())));
    }
    lens::model(top).map_err(wrong)?;
    note_unread(top, &[&["frames", "n_frames"]], file, notes).map_err(wrong)?;
    let frames: Vec<&Map<String, Value>> = frames
        .iter()
        .enumerate()
        .map(|(i, frame)| frame.as_object().ok_or_else(|| wrong(format!("frames[{i}] is not an object: correct it"))))
        .collect::<Result<_, _>>()?;
    frames.iter().enumerate().map(|(i, frame)| view(files, file, i, frame, top, notes)).collect()
}

/// The file that a path stands for.
fn file(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<PathBuf, Failure> {
    if !files.is_folder(path) {
        return Ok(path.to_path_buf());
    }
    let entries = files.list(path).map_err(|e| Failure::unreadable(path, &e))?;
    let name = |file: &Path| file.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let others: Vec<PathBuf> = entries.into_iter().filter(|file| is_split(&name(file))).collect();
    let names = others.iter().map(|file| name(file)).collect::<Vec<_>>().join(", ");
    let whole = path.join("transforms.json");
    if files.is_file(&whole) {
        if !others.is_empty() {
            notes.add(format!("{}: is read, and {names} beside it ignored", whole.display()));
        }
        return Ok(whole);
    }
    match &others[..] {
        [] => Err(Failure::Input(format!("{}: contains no transforms.json: name the file itself", path.display()))),
        [only] => Ok(path.join(name(only))),
        _ => Err(Failure::Input(format!(
            "{}: the cameras are split over {names}: name one of these files, or join their frames in one transforms.json",
            path.display()
        ))),
    }
}

/// Whether a file name is that of a part of a data set, such as transforms_train.json.
pub fn is_split(name: &str) -> bool {
    name.starts_with("transforms_") && name.ends_with(".json")
}

fn note_unread(object: &Map<String, Value>, own: &[&[&str]], file: &Path, notes: &mut Notes) -> Result<(), String> {
    let of_camera = [lens::NAMED, lens::MODEL_KEYS].into_iter().chain(intrinsics::ALL);
    let understood: Vec<&[&str]> = own.iter().copied().chain(of_camera).collect();
    let ignored = unread(object, &understood, HARMLESS)?;
    if !ignored.is_empty() {
        let poses =
            if ignored.iter().any(|key| OF_POSES.contains(key)) { "; poses are used as they are written" } else { "" };
        notes.add(format!("{}: ignored: {}{poses}", file.display(), listed(ignored)));
    }
    Ok(())
}

fn view(
    files: &dyn Files,
    file: &Path,
    index: usize,
    frame: &Map<String, Value>,
    shared: &Map<String, Value>,
    notes: &mut Notes,
) -> Result<ImportedView, Failure> {
    let path = |keys: &[&str]| find(frame, keys).and_then(|(_, value)| text(value));
    let picture = path(PICTURE)
        .ok_or_else(|| Failure::Input(format!("{}: frames[{index}] has no file_path: add it", file.display())))?;
    let name = name_of(&picture);
    let wrong = |problem: String| failure(file, &name, &problem);
    lens::model(frame).map_err(wrong)?;
    note_unread(frame, &[PICTURE, MASK, POSE, TIME], file, notes).map_err(wrong)?;

    let folder = [file.parent().unwrap_or(Path::new("")).to_path_buf()];
    let image = find_picture(files, &folder, &picture)
        .ok_or_else(|| wrong(format!("its picture `{picture}` is missing: correct file_path")))?;
    let mask = match path(MASK) {
        Some(mask) => Some(
            find_picture(files, &folder, &mask)
                .ok_or_else(|| wrong(format!("its mask `{mask}` is missing: correct mask_path or remove it")))?,
        ),
        None => None,
    };
    let levels = Levels(vec![frame, shared]);
    let [width, height] = match intrinsics::size(&levels).map_err(wrong)? {
        Some(size) => size,
        None => picture_size(files, &image, &name)?,
    };
    let (k, assumed) = intrinsics::matrix(&levels, [width, height]).map_err(wrong)?;
    if let Some(assumed) = assumed {
        notes.add(format!("{}: {assumed}", file.display()));
    }
    let lens = intrinsics::distortion(&levels).map_err(wrong)?;
    let (_, matrix) = find(frame, POSE).ok_or_else(|| wrong(String::from("transform_matrix is missing: add it")))?;
    let Pose { r, t, scale } = pose::world_to_camera(matrix).map_err(wrong)?;
    if scale != 1.0 {
        notes.add(format!(
            "camera `{name}`: {}: the axes of its transform_matrix, {scale} long, are made 1 long",
            file.display()
        ));
    }
    let camera = Camera { width, height, k, lens, r, t };
    let time = Levels(vec![frame]).number(TIME).map_err(wrong)?;
    Ok(ImportedView { name, camera, file: file.to_path_buf(), image, mask, time })
}
