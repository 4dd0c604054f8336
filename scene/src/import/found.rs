//! Cameras of files that say nothing about pictures, or only their names.

use super::{
    instants::{frame_folders, numbered},
    source::{failure, find_picture, picture_size, without_extension},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::{Camera, Lens};
use std::path::{Path, PathBuf};

/// Extensions of videos.
const VIDEOS: [&str; 5] = ["mp4", "mov", "avi", "mkv", "webm"];

/// A camera as a file describes it.
pub struct Found {
    pub name: String,
    /// Name of its picture, or of the folder with its pictures of several instants.
    pub picture: String,
    /// Default: the size of the picture.
    pub size: Option<[u32; 2]>,
    pub k: [[f64; 3]; 3],
    pub lens: Lens,
    pub r: [[f64; 3]; 3],
    pub t: [f64; 3],
}

impl Found {
    /// The views of the camera: one per picture. The pictures are searched in `folders`.
    pub fn views(self, files: &dyn Files, file: &Path, folders: &[PathBuf]) -> Result<Vec<ImportedView>, Failure> {
        let Self { name, picture, size, k, lens, r, t } = self;
        let [width, height] = match size {
            Some(size) => size,
            None => first_size(files, file, folders, [&name, &picture])?,
        };
        let pictures = pictures(files, folders, &picture)?;
        if pictures.is_empty() {
            return Err(missing(files, file, folders, [&name, &picture]));
        }
        let camera = Camera { width, height, k, lens, r, t };
        let view = |(image, time): (PathBuf, Option<f64>)| ImportedView {
            name: name.clone(),
            camera,
            file: file.to_path_buf(),
            image,
            mask: None,
            time,
        };
        Ok(pictures.into_iter().map(view).collect())
    }
}

/// Width and height of the first picture of a camera.
pub fn first_size(
    files: &dyn Files,
    file: &Path,
    folders: &[PathBuf],
    [name, picture]: [&str; 2],
) -> Result<[u32; 2], Failure> {
    match pictures(files, folders, picture)?.first() {
        Some((first, _)) => picture_size(files, first, name),
        None => Err(missing(files, file, folders, [name, picture])),
    }
}

fn missing(files: &dyn Files, file: &Path, folders: &[PathBuf], [name, picture]: [&str; 2]) -> Failure {
    let stem = without_extension(picture);
    let names = || VIDEOS.iter().map(|extension| format!("{stem}.{extension}"));
    let problem = match folders
        .iter()
        .flat_map(|folder| names().map(|name| folder.join(name)))
        .find(|p| files.is_file(p))
    {
        Some(video) => format!(
            "has a video, {}, and no pictures: write its frames to pictures `images/{stem}/000000.png` and so on, for \
             example with ffmpeg",
            video.display()
        ),
        None => {
            format!("its picture `{picture}` is missing: put it, or a folder of this name with pictures, in `images`")
        }
    };
    failure(file, name, &problem)
}

/// The pictures of a name, with their times: the single one; or those in the folder of this name, with the numbers at the end
/// of their names; or one in every folder of an instant, with the numbers of the folders.
pub fn pictures(files: &dyn Files, folders: &[PathBuf], name: &str) -> Result<Vec<(PathBuf, Option<f64>)>, Failure> {
    if let Some(single) = find_picture(files, folders, name) {
        return Ok(vec![(single, None)]);
    }
    let slashes = name.replace('\\', "/");
    for folder in folders {
        for own in [slashes.as_str(), without_extension(&slashes)].map(|name| folder.join(name)) {
            let pictures = if files.is_folder(&own) { numbered(files, &own)? } else { Vec::new() };
            if !pictures.is_empty() {
                return Ok(pictures);
            }
        }
    }
    for folder in folders {
        let frames = frame_folders(files, folder);
        let find = |(frame, number): (PathBuf, f64)| Some((find_picture(files, &[frame], name)?, Some(number)));
        let pictures: Vec<_> = frames.into_iter().filter_map(find).collect();
        if !pictures.is_empty() {
            return Ok(pictures);
        }
    }
    Ok(Vec::new())
}
