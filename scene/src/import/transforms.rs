//! NeRF's transforms.json (Blender, instant-ngp, nerfstudio): camera to world with OpenGL's axes (x right, y up,
//! z backward). The picture spans 0..w, so that the centre of the first pixel is at (0.5, 0.5).

use super::{
    source::{failure, find_picture, name_of, picture_size, read_text},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DVec3};
use pcmvs_core::Camera;
use serde::Deserialize;
use std::path::{Path, PathBuf};

#[derive(Deserialize)]
struct File {
    camera_model: Option<String>,
    #[serde(flatten)]
    shared: Intrinsics,
    frames: Vec<Frame>,
}

#[derive(Deserialize)]
struct Frame {
    file_path: String,
    mask_path: Option<String>,
    transform_matrix: Vec<[f64; 4]>,
    #[serde(flatten)]
    own: Intrinsics,
}

/// Each may be given once for all frames or for a single frame.
#[derive(Deserialize)]
struct Intrinsics {
    w: Option<f64>,
    h: Option<f64>,
    fl_x: Option<f64>,
    fl_y: Option<f64>,
    camera_angle_x: Option<f64>,
    camera_angle_y: Option<f64>,
    cx: Option<f64>,
    cy: Option<f64>,
    k1: Option<f64>,
    k2: Option<f64>,
    k3: Option<f64>,
    k4: Option<f64>,
    p1: Option<f64>,
    p2: Option<f64>,
}

/// Reads transforms.json, or a folder that contains it or transforms_train.json.
pub fn read(files: &dyn Files, path: &Path) -> Result<Vec<ImportedView>, Failure> {
    let candidates = ["transforms.json", "transforms_train.json"].map(|name| path.join(name));
    let file = if files.is_folder(path) {
        candidates.iter().find(|file| files.is_file(file)).unwrap_or(&candidates[0])
    } else {
        path
    };
    let text = read_text(files, file)?;
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
    let parsed: File = serde_json::from_str(&text).map_err(|e| wrong(format!("{e}: correct that line")))?;
    if let Some(model) = parsed.camera_model.as_deref()
        && !["OPENCV", "PINHOLE", "SIMPLE_PINHOLE"].contains(&model)
    {
        return Err(wrong(format!("camera_model {model} is not supported: undistort the pictures")));
    }
    let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
    parsed.frames.iter().map(|frame| view(files, file, &folder, frame, &parsed.shared)).collect()
}

fn view(
    files: &dyn Files,
    file: &Path,
    folder: &PathBuf,
    frame: &Frame,
    shared: &Intrinsics,
) -> Result<ImportedView, Failure> {
    let name = name_of(&frame.file_path);
    let wrong = |problem: &str| failure(file, &name, problem);
    let image = find_picture(files, std::slice::from_ref(folder), &frame.file_path)
        .ok_or_else(|| wrong("its picture is missing: correct file_path"))?;
    let of = |pick: fn(&Intrinsics) -> Option<f64>| pick(&frame.own).or_else(|| pick(shared));
    let [width, height] = match (of(|i| i.w), of(|i| i.h)) {
        (Some(w), Some(h)) => [w as u32, h as u32],
        _ => picture_size(files, &image, &name)?,
    };
    let (w, h) = (f64::from(width), f64::from(height));
    let focal = |size: f64, angle: f64| 0.5 * size / libm::tan(0.5 * angle);
    let fx = of(|i| i.fl_x).or_else(|| of(|i| i.camera_angle_x).map(|angle| focal(w, angle)));
    let fx = fx.ok_or_else(|| wrong("fl_x or camera_angle_x is needed"))?;
    let fy = of(|i| i.fl_y).or_else(|| of(|i| i.camera_angle_y).map(|angle| focal(h, angle))).unwrap_or(fx);
    let (cx, cy) = (of(|i| i.cx).unwrap_or(0.5 * w), of(|i| i.cy).unwrap_or(0.5 * h));
    if of(|i| i.k4).is_some_and(|k4| k4 != 0.0) {
        return Err(wrong("k4 is not supported: calibrate with k1 k2 p1 p2 k3, or undistort the pictures"));
    }
    let distortion = [of(|i| i.k1), of(|i| i.k2), of(|i| i.p1), of(|i| i.p2), of(|i| i.k3)].map(|v| v.unwrap_or(0.0));
    let (r, t) = pose(&frame.transform_matrix).ok_or_else(|| wrong("transform_matrix must have 3 or 4 rows"))?;
    let camera =
        Camera { width, height, k: [[fx, 0.0, cx - 0.5], [0.0, fy, cy - 0.5], [0.0, 0.0, 1.0]], distortion, r, t };
    Ok(ImportedView { name, camera, image, mask: frame.mask_path.as_ref().map(|mask| folder.join(mask)) })
}

/// World to camera with y down and z forward, from camera to world with y up and z backward.
fn pose(matrix: &[[f64; 4]]) -> Option<([[f64; 3]; 3], [f64; 3])> {
    let ([a, b, c] | [a, b, c, _]) = matrix else { return None };
    // The rows are taken as columns, which gives the inverse rotation.
    let rotation = DMat3::from_cols_array_2d(&[a, b, c].map(|row| [row[0], row[1], row[2]]));
    let rotation = DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0)) * rotation;
    let translation = -(rotation * DVec3::new(a[3], b[3], c[3]));
    Some((rotation.transpose().to_cols_array_2d(), translation.to_array()))
}
