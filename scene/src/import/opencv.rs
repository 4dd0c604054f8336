//! OpenCV calibrations in YAML or JSON, as FileStorage writes them. World to camera and the centre of the first pixel
//! follow the convention of a scene.
//!
//! A file contains one camera, or several as a list `cameras` or as named maps. A folder contains one file per camera.
//! Of the keys below, the first that exists is used:
//! - K: `camera_matrix`, `cameraMatrix`, `K`, `intrinsic_matrix`
//! - distortion k1 k2 p1 p2 k3: `distortion_coefficients`, `distCoeffs`, `dist_coeffs`, `D`, `distortion`; default: zero
//! - rotation, as a 3x3 matrix or Rodrigues' vector: `R`, `rotation_matrix`, `rotation`, `rvec`
//! - translation: `t`, `tvec`, `T`, `translation`
//! - size: `image_width` and `image_height`, `width` and `height`, or `image_size`; default: the size of the picture
//! - name: `name`; default: the key in the map, or the stem of the file
//! - picture: `image`, `image_path`, `file`; default: a picture with the camera's name, in this folder or in `images`
//! - mask: `mask`, `mask_path`; default: searched for in `masks`

use super::{
    opencv_storage,
    source::{failure, find_picture, picture_size},
    view::{ImportedView, rows},
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DQuat, DVec3};
use opencv_storage::numbers;
use pcmvs_core::Camera;
use serde_json::Value;
use std::path::{Path, PathBuf};

const K: &[&str] = &["camera_matrix", "cameraMatrix", "K", "intrinsic_matrix"];
const DISTORTION: &[&str] = &["distortion_coefficients", "distCoeffs", "dist_coeffs", "D", "distortion"];
const ROTATION: &[&str] = &["R", "rotation_matrix", "rotation", "rvec"];
const TRANSLATION: &[&str] = &["t", "tvec", "T", "translation"];
const SIZES: [[&str; 2]; 2] = [["image_width", "image_height"], ["width", "height"]];

/// Reads a file, or all YAML and JSON files of a folder that contain a camera.
pub fn read(files: &dyn Files, path: &Path) -> Result<Vec<ImportedView>, Failure> {
    let mut views = Vec::new();
    for file in calibrations(files, path)? {
        let value = opencv_storage::read(files, &file)?;
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        for (name, camera) in cameras(&value, stem) {
            views.push(view(files, &file, &name, camera)?);
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

fn find<'a>(camera: &'a Value, keys: &[&str]) -> Option<&'a Value> {
    keys.iter().find_map(|key| camera.get(key))
}

/// Names and values of the cameras in a file.
fn cameras(value: &Value, stem: String) -> Vec<(String, &Value)> {
    let named = |camera: &Value, otherwise: String| camera["name"].as_str().map_or(otherwise, str::to_owned);
    let is_camera = |value: &Value| find(value, K).is_some();
    if is_camera(value) {
        return vec![(named(value, stem), value)];
    }
    if let Some(list) = value["cameras"].as_array() {
        return list.iter().enumerate().map(|(i, c)| (named(c, format!("cam{i:02}")), c)).collect();
    }
    let map = value["cameras"].as_object().or(value.as_object());
    let entries = map.into_iter().flatten().filter(|(_, camera)| is_camera(camera));
    entries.map(|(key, camera)| (named(camera, key.clone()), camera)).collect()
}

fn view(files: &dyn Files, file: &Path, name: &str, value: &Value) -> Result<ImportedView, Failure> {
    let wrong = |problem: String| failure(file, name, &problem);
    let folder = file.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_path_buf(), folder.join("images")];
    let picture = find(value, &["image", "image_path", "file"]).and_then(Value::as_str).unwrap_or(name);
    let image = find_picture(files, &folders, picture).ok_or_else(|| {
        wrong(format!("its picture `{picture}` is missing: put it in `images` or add the key `image`"))
    })?;
    let mask = find(value, &["mask", "mask_path"]).and_then(Value::as_str).map(|mask| folder.join(mask));
    let [width, height] = match size(value).map_err(wrong)? {
        Some(size) => size,
        None => picture_size(files, &image, name)?,
    };
    let k = required(value, K).and_then(|n| to_array(&n, "K")).map_err(wrong)?;
    let t = required(value, TRANSLATION).and_then(|n| to_array(&n, "t")).map_err(wrong)?;
    let camera = Camera {
        width,
        height,
        k: rows(k),
        distortion: distortion(value).map_err(wrong)?,
        r: required(value, ROTATION).and_then(|n| rotation(&n)).map_err(wrong)?,
        t,
    };
    Ok(ImportedView { name: name.to_owned(), camera, image, mask })
}

fn required(value: &Value, keys: &[&str]) -> Result<Vec<f64>, String> {
    let found = find(value, keys).ok_or_else(|| format!("one of {keys:?} is needed"))?;
    numbers(found).map_err(|problem| format!("{}: {problem}", keys[0]))
}

fn to_array<const N: usize>(numbers: &[f64], what: &str) -> Result<[f64; N], String> {
    numbers.try_into().map_err(|_| format!("{what} has {} numbers, {N} are needed", numbers.len()))
}

fn size(value: &Value) -> Result<Option<[u32; 2]>, String> {
    let pair = SIZES.iter().find_map(|[w, h]| Some(vec![value.get(w)?, value.get(h)?]));
    let pair = pair.or_else(|| Some(vec![value.get("image_size")?]));
    let Some(pair) = pair else { return Ok(None) };
    let sizes: Result<Vec<_>, _> = pair.into_iter().map(numbers).collect();
    let sizes: [f64; 2] = to_array(&sizes?.concat(), "the image's size")?;
    Ok(Some(sizes.map(|v| v as u32)))
}

fn distortion(value: &Value) -> Result<[f64; 5], String> {
    let Some(found) = find(value, DISTORTION) else { return Ok([0.0; 5]) };
    let numbers = numbers(found).map_err(|problem| format!("{}: {problem}", DISTORTION[0]))?;
    if numbers.iter().skip(5).any(|&v| v != 0.0) {
        return Err(String::from(
            "the distortion has coefficients beyond k1 k2 p1 p2 k3: calibrate without CALIB_RATIONAL_MODEL, \
             CALIB_THIN_PRISM_MODEL and CALIB_TILTED_MODEL",
        ));
    }
    Ok(std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0)))
}

/// A rotation from nine numbers by rows, or from Rodrigues' vector (axis times angle in radians).
fn rotation(numbers: &[f64]) -> Result<[[f64; 3]; 3], String> {
    match *numbers {
        [x, y, z] => {
            let vector = DVec3::new(x, y, z);
            let (sine, cosine) = libm::sincos(0.5 * vector.length());
            let axis = vector.normalize_or_zero() * sine;
            let matrix = DMat3::from_quat(DQuat::from_xyzw(axis.x, axis.y, axis.z, cosine));
            Ok(matrix.transpose().to_cols_array_2d())
        }
        _ => to_array(numbers, "R").map(rows),
    }
}
