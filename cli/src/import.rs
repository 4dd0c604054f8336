//! `pcmvs import`: converts the calibration of another program to a scene folder. Pictures and masks are copied, so that
//! the scene does not depend on its source.

use crate::{arguments::Import, output};
use pcmvs_scene::{Disk, FILE_NAME, Failure, Imported, import, recognise};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Runs the command.
pub fn run(options: &Import) -> Result<(), Failure> {
    let source = match options.from.source() {
        Some(source) => source,
        None => recognise(&Disk, &options.path)?,
    };
    let Imported { mut scene, notes } = import(&Disk, source, &options.path)?;
    let target = options.output.join(FILE_NAME);
    if target.exists() {
        let target = target.display();
        return Err(Failure::Input(format!("{target}: exists already: name another folder or remove that file")));
    }
    let mut copies = Vec::new();
    let mut masks = 0;
    let several = scene.frames.len() > 1;
    for frame in &mut scene.frames {
        let suffix = if several { format!("_{:04}", frame.index) } else { String::new() };
        for (camera, image) in scene.cameras.iter().zip(&mut frame.images) {
            if let Some(image) = image {
                copies.push(Copy::plan(image, "images", &format!("{}{suffix}", camera.name))?);
            }
        }
        for (camera, mask) in scene.cameras.iter().zip(frame.masks.iter_mut().flatten()) {
            if let Some(mask) = mask {
                copies.push(Copy::plan(mask, "masks", &format!("{}{suffix}", camera.name))?);
                masks += 1;
            }
        }
    }
    // Before the first file is written, because the source itself may be in the folder of the scene.
    for copy in &copies {
        copy.check(&options.output)?;
    }
    for copy in &copies {
        copy.write(&options.output)?;
    }
    output::write_json(&target, &scene)?;
    for note in notes {
        eprintln!("note: {note}");
    }
    let frames = if several { format!("{} frames, ", scene.frames.len()) } else { String::new() };
    let what = if several { "masks" } else { "with masks" };
    println!("{} cameras, {frames}{masks} {what}, in {}", scene.cameras.len(), options.output.display());
    Ok(())
}

/// A file to be copied into the scene.
struct Copy {
    source: PathBuf,
    /// Relative to the scene.
    target: PathBuf,
}

impl Copy {
    /// Plans the copy of a picture into a folder of the scene, and changes the path in the scene. The name without
    /// extension is that of a camera, which is safe as a file name (see [`Imported`]), and perhaps a frame's number.
    fn plan(path: &mut PathBuf, folder: &str, name: &str) -> Result<Self, Failure> {
        let target = Path::new(folder).join(format!("{name}.{}", extension(path)?));
        Ok(Self { source: std::mem::replace(path, target.clone()), target })
    }

    /// Refuses to replace a file that is not the same already.
    fn check(&self, scene: &Path) -> Result<(), Failure> {
        let target = scene.join(&self.target);
        if target.exists() && read(&target)? != read(&self.source)? {
            let target = target.display();
            return Err(Failure::Input(format!("{target}: exists already: name another folder or remove that file")));
        }
        Ok(())
    }

    fn write(&self, scene: &Path) -> Result<(), Failure> {
        output::write(&scene.join(&self.target), &read(&self.source)?)
    }
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|e| Failure::unreadable(path, &e))
}

/// The extension for a copy of a picture: its own, or that of its format.
fn extension(path: &Path) -> Result<String, Failure> {
    let own = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if ["png", "jpg", "jpeg"].contains(&own.as_str()) {
        return Ok(own);
    }
    let is_png = read(path)?.starts_with(b"\x89PNG");
    Ok(String::from(if is_png { "png" } else { "jpg" }))
}
