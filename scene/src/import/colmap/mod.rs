//! COLMAP's models, as text or binary. World to camera as in a scene, but the quaternion has w first and the first pixel's
//! centre is at (0.5, 0.5).

mod binary;
mod model;
mod text;

use super::{
    names::name_of,
    notes::Notes,
    source::{failure, find_picture},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DQuat};
use model::{Image, Lens};
use pcmvs_core::Camera;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// Files that newer versions write beside the model.
const BESIDE: [&str; 4] = ["rigs.txt", "frames.txt", "rigs.bin", "frames.bin"];

/// The folders of a project in which its model may be.
pub fn model_folders(path: &Path) -> [PathBuf; 3] {
    [path.to_path_buf(), path.join("sparse"), path.join("sparse").join("0")]
}

/// Whether a folder contains a model.
pub fn is_model(files: &dyn Files, folder: &Path) -> bool {
    ["cameras.txt", "cameras.bin"].iter().any(|name| files.is_file(&folder.join(name)))
}

/// Reads a folder with a model, or a project whose model is in `sparse` or `sparse/0`.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    // One of the model's files stands for its folder.
    let is_part = files.is_file(path) && path.file_stem().is_some_and(|stem| stem == "cameras" || stem == "images");
    let path = if is_part { path.parent().unwrap_or(Path::new("")) } else { path };
    let Some(model) = model_folders(path).into_iter().find(|folder| is_model(files, folder)) else {
        return Err(Failure::Input(format!(
            "{}: there is neither cameras.txt nor cameras.bin: name the folder of a COLMAP model",
            path.display()
        )));
    };
    let text = files.is_file(&model.join("cameras.txt"));
    if text && files.is_file(&model.join("cameras.bin")) {
        notes.add(format!("{}: the text model is read, and the binary one beside it ignored", model.display()));
    }
    if BESIDE.iter().any(|name| files.is_file(&model.join(name))) {
        notes.add(format!("{}: rigs and frames are ignored: every image is a camera", model.display()));
    }
    if model.ends_with("sparse/0") && is_model(files, &model.with_file_name("1")) {
        notes.add(format!("{}: is read, and the other models beside it are not", model.display()));
    }
    let (lenses, images, [cameras, file]) = if text {
        let [cameras, images] = ["cameras.txt", "images.txt"].map(|name| model.join(name));
        (text::read_cameras(files, &cameras)?, text::read_images(files, &images, notes)?, [cameras, images])
    } else {
        let [cameras, images] = ["cameras.bin", "images.bin"].map(|name| model.join(name));
        (binary::read_cameras(files, &cameras)?, binary::read_images(files, &images)?, [cameras, images])
    };
    let up = |levels: usize| model.ancestors().nth(levels).map(|folder| folder.join("images"));
    let mut folders: Vec<PathBuf> = [path.join("images"), path.to_path_buf()].into();
    folders.extend([up(0), up(1), up(2)].into_iter().flatten());
    let unused = lenses.keys().filter(|id| images.iter().all(|image| image.camera != **id)).count();
    if unused > 0 {
        notes.add(format!("{}: {unused} of {} lenses belong to no image", model.display(), lenses.len()));
    }
    let mut views: Vec<_> = images
        .iter()
        .map(|image| view(files, [&cameras, &file], image, &lenses, &folders))
        .collect::<Result<_, _>>()?;
    // COLMAP lists images in the order of their registration.
    views.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(views)
}

fn view(
    files: &dyn Files,
    [cameras, file]: [&Path; 2],
    image: &Image,
    lenses: &BTreeMap<u32, Lens>,
    folders: &[PathBuf],
) -> Result<ImportedView, Failure> {
    let name = name_of(&image.name);
    let wrong = |problem: String| failure(file, &name, &problem);
    let lens = lenses.get(&image.camera);
    let lens = lens.ok_or_else(|| wrong(format!("the model has no camera {}: export it again", image.camera)))?;
    let (k, distortion) =
        lens.intrinsics().map_err(|problem| failure(cameras, &name, &format!("camera {}: {problem}", image.camera)))?;
    let picture = find_picture(files, folders, &image.name)
        .ok_or_else(|| wrong(format!("its picture `{}` is missing: put it in `images`", image.name)))?;
    let [w, x, y, z] = image.quaternion;
    let [width, height] = lens.size;
    let camera = Camera {
        width,
        height,
        k,
        lens: distortion,
        r: DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()).transpose().to_cols_array_2d(),
        t: image.translation,
    };
    Ok(ImportedView { name, camera, file: file.to_path_buf(), image: picture, mask: None, time: None })
}
