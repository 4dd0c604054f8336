//! Other programs' calibrations as scenes of one frame.
//!
//! Every importer turns its convention into the scene's: world to camera `x = K · distort(R X + t)`, x right, y down,
//! z forward, the first pixel's centre at (0, 0).

mod colmap;
mod middlebury;
mod opencv;
mod opencv_storage;
mod transforms;

use crate::{
    failure::Failure,
    files::Files,
    pictures::Picture,
    scene::{Scene, SceneCamera, SceneFrame, VERSION},
};
use pcmvs_core::Camera;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Programs whose calibrations can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A folder with `*_par.txt`, or that file.
    Middlebury,
    /// A folder with a text model: cameras.txt and images.txt.
    Colmap,
    /// A YAML or JSON file of OpenCV's FileStorage, or a folder of one such file a camera.
    Opencv,
    /// transforms.json or its folder.
    Transforms,
}

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

/// Reads another program's calibration as a scene of one frame, whose picture paths are those of the source.
pub fn import(files: &dyn Files, source: Source, path: &Path) -> Result<Scene, Failure> {
    let views = match source {
        Source::Middlebury => middlebury::read(files, path)?,
        Source::Colmap => colmap::read(files, path)?,
        Source::Opencv => opencv::read(files, path)?,
        Source::Transforms => transforms::read(files, path)?,
    };
    let mut names = BTreeSet::new();
    let (mut cameras, mut images, mut masks) = (Vec::new(), Vec::new(), Vec::new());
    for view in &views {
        if !names.insert(view.name.as_str()) {
            return Err(failure(path, &view.name, "is there twice: give every camera a name of its own"));
        }
        view.camera.check().map_err(|problem| failure(path, &view.name, &problem))?;
        let [width, height] = picture_size(files, &view.image, &view.name)?;
        if [width, height] != [view.camera.width, view.camera.height] {
            let problem = format!(
                "the picture is {width} x {height} pixels but the camera was calibrated at {} x {}: \
                 give pictures of the calibrated size",
                view.camera.width, view.camera.height
            );
            return Err(failure(&view.image, &view.name, &problem));
        }
        images.push(view.image.clone());
        masks.push(view.mask.clone().or_else(|| usual_mask(files, path, &view.image)));
        cameras.push(scene_camera(view));
    }
    if cameras.is_empty() {
        return Err(Failure::Input(format!("{}: holds no camera", path.display())));
    }
    Ok(Scene {
        version: VERSION,
        units: None,
        up: None,
        fps: None,
        cameras,
        frames: vec![SceneFrame { index: 0, images, masks: Some(masks) }],
        background: None,
        path: PathBuf::new(),
    })
}

fn scene_camera(view: &ImportedView) -> SceneCamera {
    let Camera { width, height, k, distortion, r, t } = view.camera;
    SceneCamera { name: view.name.clone(), width, height, k, distortion: distortion.to_vec(), r, t }
}

/// What is wrong with a camera, and in which file.
fn failure(path: &Path, camera: &str, problem: &str) -> Failure {
    Failure::Input(format!("camera `{camera}`: {}: {problem}", path.display()))
}

fn read(files: &dyn Files, path: &Path) -> Result<Vec<u8>, Failure> {
    files.read(path).map_err(|e| Failure::unreadable(path, &e))
}

fn read_text(files: &dyn Files, path: &Path) -> Result<String, Failure> {
    String::from_utf8(read(files, path)?)
        .map_err(|_| Failure::Input(format!("{}: this is not UTF-8 text: save it as UTF-8", path.display())))
}

/// Width and height of a picture.
fn picture_size(files: &dyn Files, path: &Path, camera: &str) -> Result<[u32; 2], Failure> {
    let picture = Picture::decode(&read(files, path)?).map_err(|problem| failure(path, camera, &problem))?;
    Ok([picture.view().width, picture.view().height])
}

/// The first of the folders that holds a file of this name, with or without a picture's extension.
fn find_picture(files: &dyn Files, folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    let spelled =
        |folder: &PathBuf| ["", ".png", ".jpg", ".jpeg"].map(|extension| folder.join(format!("{name}{extension}")));
    folders.iter().flat_map(spelled).find(|path| files.is_file(path))
}

/// A mask in a folder `masks` beside the pictures, beside their folder or in the capture's: of the same stem, or of the
/// picture's whole name with another extension added.
fn usual_mask(files: &dyn Files, capture: &Path, image: &Path) -> Option<PathBuf> {
    let folder = image.parent()?;
    let capture = if files.is_folder(capture) { capture } else { capture.parent()? };
    let beside = folder.parent().unwrap_or(folder);
    let folders = [folder, beside, capture].map(|f| f.join("masks"));
    let name = |part: Option<&std::ffi::OsStr>| part.map(|s| s.to_string_lossy().into_owned());
    let find = |name: String| find_picture(files, &folders, &name);
    find(name(image.file_stem())?).or_else(|| find(name(image.file_name())?))
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
