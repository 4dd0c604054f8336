//! The files of a calibrated capture: text, pictures and masks.

use crate::{failure::Failure, files::Files, pictures::Picture};
use std::path::{Path, PathBuf};

/// An error message that names camera and file.
pub fn failure(path: &Path, camera: &str, problem: &str) -> Failure {
    Failure::Input(format!("camera `{camera}`: {}: {problem}", path.display()))
}

pub fn read(files: &dyn Files, path: &Path) -> Result<Vec<u8>, Failure> {
    files.read(path).map_err(|e| Failure::unreadable(path, &e))
}

pub fn read_text(files: &dyn Files, path: &Path) -> Result<String, Failure> {
    String::from_utf8(read(files, path)?)
        .map_err(|_| Failure::Input(format!("{}: the file is not UTF-8 text: save it as UTF-8", path.display())))
}

/// Width and height of a picture.
pub fn picture_size(files: &dyn Files, path: &Path, camera: &str) -> Result<[u32; 2], Failure> {
    let picture = Picture::decode(&read(files, path)?).map_err(|problem| failure(path, camera, &problem))?;
    Ok([picture.view().width, picture.view().height])
}

/// The file of this name, with or without the extension of a picture, in the first folder that contains one.
pub fn find_picture(files: &dyn Files, folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    let spelled =
        |folder: &PathBuf| ["", ".png", ".jpg", ".jpeg"].map(|extension| folder.join(format!("{name}{extension}")));
    folders.iter().flat_map(spelled).find(|path| files.is_file(path))
}

/// A mask in a folder `masks`: in the folder of the pictures, next to it, or in the capture's folder. It has the stem of
/// the picture, or the picture's full name with another extension added.
pub fn usual_mask(files: &dyn Files, capture: &Path, image: &Path) -> Option<PathBuf> {
    let folder = image.parent()?;
    let capture = if files.is_folder(capture) { capture } else { capture.parent()? };
    let beside = folder.parent().unwrap_or(folder);
    let folders = [folder, beside, capture].map(|f| f.join("masks"));
    let name = |part: Option<&std::ffi::OsStr>| part.map(|s| s.to_string_lossy().into_owned());
    let find = |name: String| find_picture(files, &folders, &name);
    find(name(image.file_stem())?).or_else(|| find(name(image.file_name())?))
}

/// A camera name from the path of its picture. Folders become part of the name.
pub fn name_of(path: &str) -> String {
    let path = Path::new(path.trim_start_matches("./")).with_extension("");
    path.to_string_lossy().replace(['/', '\\'], "_")
}
