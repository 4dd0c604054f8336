//! `pcmvs import`: converts the calibration of another program to a scene folder. Pictures and masks are copied, so that
//! the scene does not depend on its source.

use crate::{arguments::Import, output};
use pcmvs_scene::{Disk, FILE_NAME, Failure, import};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Runs the command.
pub fn run(options: &Import) -> Result<(), Failure> {
    let mut scene = import(&Disk, options.from.source(), &options.path)?;
    let target = options.output.join(FILE_NAME);
    if target.exists() {
        let target = target.display();
        return Err(Failure::Input(format!("{target}: exists already: name another folder or remove that file")));
    }
    let mut masks = 0;
    for frame in &mut scene.frames {
        for (camera, image) in scene.cameras.iter().zip(&mut frame.images) {
            if let Some(image) = image {
                *image = copy(image, &options.output, "images", &camera.name)?;
            }
        }
        for (camera, mask) in scene.cameras.iter().zip(frame.masks.iter_mut().flatten()) {
            if let Some(mask) = mask {
                *mask = copy(mask, &options.output, "masks", &camera.name)?;
                masks += 1;
            }
        }
    }
    println!("{} cameras, {masks} with masks, in {}", scene.cameras.len(), options.output.display());
    output::write_json(&target, &scene)
}

/// Copies a file into a folder of the scene and names it after the camera. Returns its path relative to the scene.
fn copy(source: &Path, scene: &Path, folder: &str, name: &str) -> Result<PathBuf, Failure> {
    let extension = source.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let relative = Path::new(folder).join(format!("{name}.{extension}"));
    let bytes = fs::read(source).map_err(|e| Failure::unreadable(source, &e))?;
    output::write(&scene.join(&relative), &bytes)?;
    Ok(relative)
}
