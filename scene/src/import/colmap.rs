//! COLMAP's text model: cameras.txt and images.txt. World to camera as in a scene, but the quaternion has w first and
//! the first pixel's centre is at (0.5, 0.5).

use super::{
    source::{failure, find_picture, name_of, read_text},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DQuat};
use pcmvs_core::Camera;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

struct Intrinsics {
    size: [u32; 2],
    k: [[f64; 3]; 3],
    distortion: [f64; 5],
}

/// Reads a folder with cameras.txt and images.txt, or a project whose model is in `sparse` or `sparse/0`.
pub fn read(files: &dyn Files, path: &Path) -> Result<Vec<ImportedView>, Failure> {
    let candidates = [path.to_path_buf(), path.join("sparse"), path.join("sparse").join("0")];
    let Some(model) = candidates.iter().find(|folder| files.is_file(&folder.join("cameras.txt"))) else {
        let binary = candidates.iter().any(|folder| files.is_file(&folder.join("cameras.bin")));
        let remedy = if binary {
            "the model is binary: convert it with `colmap model_converter --output_type TXT`"
        } else {
            "there is no cameras.txt: name the folder of a COLMAP text model"
        };
        return Err(Failure::Input(format!("{}: {remedy}", path.display())));
    };
    let intrinsics = read_cameras(files, &model.join("cameras.txt"))?;
    let up = |levels: usize| model.ancestors().nth(levels).map(|folder| folder.join("images"));
    let mut folders: Vec<PathBuf> = [path.join("images"), path.to_path_buf()].into();
    folders.extend([up(0), up(1), up(2)].into_iter().flatten());
    let mut views = read_images(files, &model.join("images.txt"), &intrinsics, &folders)?;
    // COLMAP lists images in the order of their registration.
    views.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(views)
}

fn read_cameras(files: &dyn Files, file: &Path) -> Result<BTreeMap<u32, Intrinsics>, Failure> {
    let text = read_text(files, file)?;
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let wrong = |line: &str, problem: &str| {
        Failure::Input(format!("{}: camera {}: {problem}", file.display(), line.split(' ').next().unwrap_or_default()))
    };
    let parse = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [id, model, width, height, params @ ..] = words.as_slice() else { return Err(String::from("too short")) };
        let whole = |word: &str| word.parse::<u32>().map_err(|_| format!("`{word}` is not a whole number"));
        let params: Result<Vec<f64>, _> =
            params.iter().map(|p| p.parse().map_err(|_| format!("`{p}` is not a number"))).collect();
        let (k, distortion) = intrinsics(model, &params?)?;
        Ok((whole(id)?, Intrinsics { size: [whole(width)?, whole(height)?], k, distortion }))
    };
    lines.map(|line| parse(line).map_err(|problem| wrong(line, &problem))).collect()
}

/// K and distortion from the parameters of a camera model.
fn intrinsics(model: &str, params: &[f64]) -> Result<([[f64; 3]; 3], [f64; 5]), String> {
    let (focal, centre, [k1, k2, p1, p2, k3]) = match (model, params) {
        ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f], [cx, cy], [0.0; 5]),
        ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy], [cx, cy], [0.0; 5]),
        ("SIMPLE_RADIAL", &[f, cx, cy, k1]) => ([f, f], [cx, cy], [k1, 0.0, 0.0, 0.0, 0.0]),
        ("RADIAL", &[f, cx, cy, k1, k2]) => ([f, f], [cx, cy], [k1, k2, 0.0, 0.0, 0.0]),
        ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => ([fx, fy], [cx, cy], [k1, k2, p1, p2, 0.0]),
        ("FULL_OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6]) => {
            if [k4, k5, k6] != [0.0; 3] {
                return Err(String::from(
                    "FULL_OPENCV with k4, k5 or k6 is not supported: calibrate with OPENCV, or undistort with \
                     `colmap image_undistorter`",
                ));
            }
            ([fx, fy], [cx, cy], [k1, k2, p1, p2, k3])
        }
        ("SIMPLE_PINHOLE" | "PINHOLE" | "SIMPLE_RADIAL" | "RADIAL" | "OPENCV" | "FULL_OPENCV", _) => {
            return Err(format!("{} parameters do not fit the model {model}: export the model again", params.len()));
        }
        _ => {
            return Err(format!(
                "the model {model} is not supported: undistort the pictures with `colmap image_undistorter`"
            ));
        }
    };
    let k = [[focal[0], 0.0, centre[0] - 0.5], [0.0, focal[1], centre[1] - 0.5], [0.0, 0.0, 1.0]];
    Ok((k, [k1, k2, p1, p2, k3]))
}

fn read_images(
    files: &dyn Files,
    file: &Path,
    intrinsics: &BTreeMap<u32, Intrinsics>,
    folders: &[PathBuf],
) -> Result<Vec<ImportedView>, Failure> {
    let text = read_text(files, file)?;
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let mut views = Vec::new();
    while let Some(line) = lines.by_ref().find(|line| !line.trim().is_empty()) {
        // The next line has the 2D points of the image and may be empty.
        lines.next();
        let words: Vec<&str> = line.split_whitespace().collect();
        let [_, pose @ .., _, _] = &words[..words.len().min(10)] else { continue };
        let pose: Option<Vec<f64>> = pose.iter().map(|word| word.parse().ok()).collect();
        let Some(Ok([w, x, y, z, tx, ty, tz])) = pose.map(<[f64; 7]>::try_from) else {
            return Err(Failure::Input(format!(
                "{}: `{line}` is not an image: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME is needed",
                file.display()
            )));
        };
        let picture = words[9..].join(" ");
        let name = name_of(&picture);
        let lens = words[8].parse().ok().and_then(|id: u32| intrinsics.get(&id));
        let lens = lens.ok_or_else(|| failure(file, &name, &format!("cameras.txt has no camera {}", words[8])))?;
        let image = find_picture(files, folders, &picture)
            .ok_or_else(|| failure(file, &name, &format!("its picture `{picture}` is missing: put it in `images`")))?;
        let [width, height] = lens.size;
        let camera = Camera {
            width,
            height,
            k: lens.k,
            distortion: lens.distortion,
            r: DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()).transpose().to_cols_array_2d(),
            t: [tx, ty, tz],
        };
        views.push(ImportedView { name, camera, image, mask: None });
    }
    Ok(views)
}
