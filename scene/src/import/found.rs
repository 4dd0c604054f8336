//! Cameras of files that say nothing about pictures, or only their names.

use super::{
    instants::{frame_folders, numbered},
    notes::Notes,
    source::{failure, find_picture, picture_size, without_extension},
    video_names::{self, Video},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::{Camera, Lens};
use std::path::{Path, PathBuf};

/// A camera as a file describes it.
#[derive(Debug, Clone)]
pub struct Found {
    pub name: String,
    /// Name of its picture, or of the folder with its pictures of several instants, or of its video.
    pub picture: String,
    /// Default: the size of the picture.
    pub size: Option<[u32; 2]>,
    pub k: [[f64; 3]; 3],
    pub lens: Lens,
    pub r: [[f64; 3]; 3],
    pub t: [f64; 3],
}

impl Found {
    /// The views of the camera: one per picture, or one with its video. They are searched in `folders`.
    pub fn views(
        self,
        files: &dyn Files,
        file: &Path,
        folders: &[PathBuf],
        notes: &mut Notes,
    ) -> Result<Vec<ImportedView>, Failure> {
        let Self { name, picture, size, k, lens, r, t } = self;
        let [width, height] = match size {
            Some(size) => size,
            None => first_size(files, file, folders, [&name, &picture])?,
        };
        let mut pictures = pictures(files, folders, &picture)?;
        let video = || video_names::find(files, folders, &[without_extension(&picture)]);
        if pictures.is_empty() {
            let video = video().map_err(|problem| failure(file, &name, &problem))?;
            let video = video.ok_or_else(|| missing(file, [&name, &picture]))?;
            video.note(&name, notes);
            pictures.push((video.path, None));
        } else if let Some(other) = passed_over(files, folders, &picture, &pictures)
            .or_else(|| video().ok()?.filter(Video::is_exact).map(|v| v.path))
            && !pictures.iter().any(|(taken, _)| *taken == other)
        {
            notes.add(format!(
                "camera `{name}`: {} is taken, and {} is not: move the wrong one away",
                pictures[0].0.display(),
                other.display()
            ));
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
        None => {
            let stem = without_extension(picture);
            let video = video_names::find(files, folders, &[stem]).map_err(|problem| failure(file, name, &problem))?;
            Err(match video {
                Some(Video { path, .. }) => {
                    let problem = format!(
                        "has a video, {}, and no pictures, and the file does not tell their size: write the frames of the \
                         video to pictures `images/{stem}/000000.png` and so on, for example with ffmpeg",
                        path.display()
                    );
                    failure(file, name, &problem)
                }
                None => missing(file, [name, picture]),
            })
        }
    }
}

fn missing(file: &Path, [name, picture]: [&str; 2]) -> Failure {
    let problem =
        format!("its picture `{picture}` is missing: put it, or a folder of this name with pictures, in `images`");
    failure(file, name, &problem)
}

/// The folder of pictures that has the name of the single picture that was found, and that is passed over therefore.
fn passed_over(
    files: &dyn Files,
    folders: &[PathBuf],
    name: &str,
    found: &[(PathBuf, Option<f64>)],
) -> Option<PathBuf> {
    let is_single = matches!(found, [(_, None)]);
    own_folders(folders, name).find(|own| {
        is_single && files.is_folder(own) && numbered(files, own).is_ok_and(|pictures| !pictures.is_empty())
    })
}

/// The folders that may have the pictures of a name.
fn own_folders(folders: &[PathBuf], name: &str) -> impl Iterator<Item = PathBuf> {
    let whole = name.replace('\\', "/");
    let stem = without_extension(&whole).to_owned();
    folders.iter().flat_map(move |folder| [folder.join(&whole), folder.join(&stem)])
}

/// The pictures of a name, with their times: the single one; or those in the folder of this name, with the numbers at the end
/// of their names; or one in every folder of an instant, with the numbers of the folders.
pub fn pictures(files: &dyn Files, folders: &[PathBuf], name: &str) -> Result<Vec<(PathBuf, Option<f64>)>, Failure> {
    if let Some(single) = find_picture(files, folders, name) {
        return Ok(vec![(single, None)]);
    }
    for own in own_folders(folders, name) {
        let pictures = if files.is_folder(&own) { numbered(files, &own)? } else { Vec::new() };
        if !pictures.is_empty() {
            return Ok(pictures);
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
