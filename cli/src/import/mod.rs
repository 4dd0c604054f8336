//! `pcmvs import`: other programs' calibrations as scenes of one frame.
//!
//! Every importer turns its convention into the scene's: world to camera `x = K · distort(R X + t)`, x right, y down,
//! z forward, the first pixel's centre at (0, 0). Pictures and masks are copied, so that a scene stays whole when its
//! source moves.

mod colmap;
mod middlebury;
mod opencv;
mod opencv_storage;
mod transforms;

use crate::{
    arguments::{Import, Source},
    failure::Failure,
    output,
    pictures::Picture,
    scene::{FILE_NAME, Scene, SceneCamera, SceneFrame, VERSION},
};
use pcmvs_core::Camera;
use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

/// A view as an importer found it.
#[derive(Debug, Clone)]
struct ImportedView {
    name: String,
    camera: Camera,
    /// The photograph.
    image: PathBuf,
    /// Its mask; where the source does not say, the usual places are searched.
    mask: Option<PathBuf>,
}

/// Runs the command.
pub fn run(options: &Import) -> Result<(), Failure> {
    let views = match options.from {
        Source::Middlebury => middlebury::read(&options.path)?,
        Source::Colmap => colmap::read(&options.path)?,
        Source::Opencv => opencv::read(&options.path)?,
        Source::Transforms => transforms::read(&options.path)?,
    };
    let target = options.output.join(FILE_NAME);
    if target.exists() {
        let target = target.display();
        return Err(Failure::Input(format!("{target}: is there already: name another folder or remove that file")));
    }
    let mut scene = Scene {
        version: VERSION,
        units: None,
        up: None,
        fps: None,
        cameras: Vec::new(),
        frames: Vec::new(),
        background: None,
        path: target.clone(),
    };
    let mut names = BTreeSet::new();
    let (mut images, mut masks) = (Vec::new(), Vec::new());
    for view in &views {
        if !names.insert(view.name.as_str()) {
            return Err(failure(&options.path, &view.name, "is there twice: give every camera a name of its own"));
        }
        view.camera.check().map_err(|problem| failure(&options.path, &view.name, &problem))?;
        let [width, height] = picture_size(&view.image, &view.name)?;
        if [width, height] != [view.camera.width, view.camera.height] {
            let problem = format!(
                "the picture is {width} x {height} pixels but the camera was calibrated at {} x {}: \
                 give pictures of the calibrated size",
                view.camera.width, view.camera.height
            );
            return Err(failure(&view.image, &view.name, &problem));
        }
        images.push(copy(&view.image, &options.output, "images", &view.name)?);
        let mask = view.mask.clone().or_else(|| usual_mask(&options.path, &view.image));
        masks.push(mask.map(|mask| copy(&mask, &options.output, "masks", &view.name)).transpose()?);
        scene.cameras.push(scene_camera(view));
    }
    if scene.cameras.is_empty() {
        return Err(Failure::Input(format!("{}: holds no camera", options.path.display())));
    }
    println!("{} cameras, {} with masks, in {}", views.len(), masks.iter().flatten().count(), options.output.display());
    scene.frames.push(SceneFrame { index: 0, images, masks: Some(masks) });
    output::write_json(&target, &scene)
}

fn scene_camera(view: &ImportedView) -> SceneCamera {
    let Camera { width, height, k, distortion, r, t } = view.camera;
    SceneCamera { name: view.name.clone(), width, height, k, distortion: distortion.to_vec(), r, t }
}

/// Copies a file into a folder of the scene under the camera's name; returns its path within the scene.
fn copy(source: &Path, scene: &Path, folder: &str, name: &str) -> Result<PathBuf, Failure> {
    let extension = source.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let relative = Path::new(folder).join(format!("{name}.{extension}"));
    let bytes = fs::read(source).map_err(|e| Failure::unreadable(source, &e))?;
    output::write(&scene.join(&relative), &bytes)?;
    Ok(relative)
}

/// What is wrong with a camera, and in which file.
fn failure(path: &Path, camera: &str, problem: &str) -> Failure {
    Failure::Input(format!("camera `{camera}`: {}: {problem}", path.display()))
}

fn read_text(path: &Path) -> Result<String, Failure> {
    fs::read_to_string(path).map_err(|e| Failure::unreadable(path, &e))
}

/// Width and height of a picture.
fn picture_size(path: &Path, camera: &str) -> Result<[u32; 2], Failure> {
    let bytes = fs::read(path).map_err(|e| Failure::unreadable(path, &e))?;
    let picture = Picture::decode(&bytes).map_err(|problem| failure(path, camera, &problem))?;
    Ok([picture.view().width, picture.view().height])
}

/// The first of the folders that holds a file of this name, with or without a picture's extension.
fn find_picture(folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    let spelled =
        |folder: &PathBuf| ["", ".png", ".jpg", ".jpeg"].map(|extension| folder.join(format!("{name}{extension}")));
    folders.iter().flat_map(spelled).find(|path| path.is_file())
}

/// A mask in a folder `masks` beside the pictures, beside their folder or in the capture's: of the same stem, or of the
/// picture's whole name with another extension added.
fn usual_mask(capture: &Path, image: &Path) -> Option<PathBuf> {
    let folder = image.parent()?;
    let capture = if capture.is_dir() { capture } else { capture.parent()? };
    let beside = folder.parent().unwrap_or(folder);
    let folders = [folder, beside, capture].map(|f| f.join("masks"));
    let name = |part: Option<&std::ffi::OsStr>| part.map(|s| s.to_string_lossy().into_owned());
    find_picture(&folders, &name(image.file_stem())?).or_else(|| find_picture(&folders, &name(image.file_name())?))
}

/// A camera's name from its picture's path: folders become part of the name.
fn name_of(path: &str) -> String {
    let path = Path::new(path.trim_start_matches("./")).with_extension("");
    path.to_string_lossy().replace(['/', '\\'], "_")
}

/// Rows of three from nine numbers.
fn rows(m: [f64; 9]) -> [[f64; 3]; 3] {
    [[m[0], m[1], m[2]], [m[3], m[4], m[5]], [m[6], m[7], m[8]]]
}
