//! Other programs' calibrations as scenes of one frame.
//!
//! Every importer turns its convention into the scene's: world to camera `x = K · distort(R X + t)`, x right, y down,
//! z forward, the first pixel's centre at (0, 0).

mod colmap;
mod middlebury;
mod opencv;
mod opencv_storage;
mod source;
mod transforms;
mod view;

use crate::{
    failure::Failure,
    files::Files,
    scene::{Scene, SceneCamera, SceneFrame, SilhouetteFiles, VERSION},
};
use pcmvs_core::Camera;
use source::{failure, picture_size, usual_mask};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};
use view::ImportedView;

/// Programs whose calibrations can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A folder with `*_par.txt`, or that file.
    Middlebury,
    /// A folder with a text model: cameras.txt and images.txt.
    Colmap,
    /// A YAML or JSON file of OpenCV's FileStorage, or a folder with one such file per camera.
    Opencv,
    /// transforms.json or its folder.
    Transforms,
}

/// Reads the calibration of another program as a scene with one frame. Picture paths are those of the source.
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
            return Err(failure(path, &view.name, "occurs twice: give every camera its own name"));
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
        images.push(Some(view.image.clone()));
        masks.push(view.mask.clone().or_else(|| usual_mask(files, path, &view.image)));
        cameras.push(scene_camera(view));
    }
    if cameras.is_empty() {
        return Err(Failure::Input(format!("{}: contains no camera", path.display())));
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
        silhouettes: SilhouetteFiles::default(),
    })
}

fn scene_camera(view: &ImportedView) -> SceneCamera {
    let Camera { width, height, k, distortion, r, t } = view.camera;
    SceneCamera { name: view.name.clone(), width, height, k, distortion: distortion.to_vec(), r, t }
}
