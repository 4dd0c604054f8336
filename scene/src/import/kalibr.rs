//! Kalibr's camchain.yaml: cameras `cam0`, `cam1`, ... Each has its pose in that of the camera before it, `T_cn_cnm1`. The
//! first camera is the scene's origin. The first pixel's centre is at (0, 0).

use super::{
    found::Found,
    keys::{listed, unread},
    lens,
    notes::Notes,
    opencv_storage,
    source::failure,
    values::{self, Levels, numbers, to_array},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DVec3};
use serde_json::{Map, Value};
use std::path::Path;

/// The pose of a camera in that of the one before it.
pub const CHAIN: &str = "T_cn_cnm1";
const KEYS: &[&str] = &[CHAIN, "intrinsics", "distortion_coeffs", "resolution", "camera_model", "distortion_model"];
/// The IMU's pose, which only repeats the chain.
const HARMLESS: &[&str] = &["T_cam_imu", "timeshift_cam_imu", "cam_overlaps", "rostopic"];

/// Reads the file.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let value = opencv_storage::read(files, path)?;
    let wrong = |problem: &str| Failure::Input(format!("{}: {problem}", path.display()));
    let top = value.as_object().ok_or_else(|| wrong("is not a map of cameras: name a camchain.yaml"))?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_path_buf(), folder.join("images")];
    let (mut r, mut t) = (DMat3::IDENTITY, DVec3::ZERO);
    let mut views = Vec::new();
    for i in 0..top.len() {
        let name = format!("cam{i}");
        let missing = || wrong(&format!("`{name}` is missing: cameras must be cam0, cam1, ... without a gap"));
        let keys = top.get(&name).ok_or_else(missing)?;
        let of_camera = |problem: String| failure(path, &name, &problem);
        let keys = keys.as_object().ok_or_else(|| of_camera(String::from("is not a map of keys and values")))?;
        let ignored = unread(keys, &[KEYS], HARMLESS).map_err(of_camera)?;
        if !ignored.is_empty() {
            notes.add(format!("{}: ignored: {}", path.display(), listed(ignored)));
        }
        if i > 0 {
            let (step_r, step_t) = step(keys).map_err(of_camera)?;
            (r, t) = (step_r * r, step_r * t + step_t);
        }
        let found = camera(&name, keys, r, t).map_err(of_camera)?;
        views.extend(found.views(files, path, &folders, notes)?);
    }
    Ok(views)
}

fn list<const N: usize>(keys: &Map<String, Value>, key: &str) -> Result<[f64; N], String> {
    let value = keys.get(key).ok_or_else(|| format!("`{key}` is missing: add it"))?;
    numbers(value).and_then(|list| to_array(&list, key))
}

/// Rotation and translation from the camera before.
fn step(keys: &Map<String, Value>) -> Result<(DMat3, DVec3), String> {
    let m: [f64; 16] = list(keys, CHAIN)?;
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(format!("{CHAIN} must have 0 0 0 1 in its last row"));
    }
    let row = |i: usize| [m[4 * i], m[4 * i + 1], m[4 * i + 2]];
    let r = DMat3::from_cols_array_2d(&[row(0), row(1), row(2)]).transpose();
    Ok((r, DVec3::new(m[3], m[7], m[11])))
}

fn camera(name: &str, keys: &Map<String, Value>, r: DMat3, t: DVec3) -> Result<Found, String> {
    let pinhole = keys.get("camera_model").and_then(Value::as_str);
    if pinhole != Some("pinhole") {
        let named = pinhole.unwrap_or("of no name");
        return Err(format!("the camera_model {named} is not supported, only `pinhole`: {}", lens::REMEDY));
    }
    let model = lens::of_levels(&Levels(vec![keys]))?;
    let lens = match keys.get("distortion_coeffs") {
        Some(value) => lens::from_list("distortion_coeffs", &numbers(value)?, model)?,
        None => lens::plainest(model),
    };
    let [fx, fy, cx, cy] = list(keys, "intrinsics")?;
    let [width, height] = list(keys, "resolution")?;
    Ok(Found {
        name: name.to_owned(),
        picture: name.to_owned(),
        size: Some(values::size(width, height)?),
        k: [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]],
        lens,
        r: r.transpose().to_cols_array_2d(),
        t: t.to_array(),
    })
}
