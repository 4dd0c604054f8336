//! The files of a calibrated capture: text, pictures and masks.

use crate::{failure::Failure, files::Files, pictures::Picture, text};
use std::path::{Path, PathBuf};

/// Extensions of pictures that can be read.
const EXTENSIONS: [&str; 3] = ["png", "jpg", "jpeg"];
/// Extensions of videos.
const VIDEOS: [&str; 5] = ["mp4", "mov", "avi", "mkv", "webm"];

/// An error message that names camera and file.
pub fn failure(path: &Path, camera: &str, problem: &str) -> Failure {
    Failure::Input(format!("camera `{camera}`: {}: {problem}", path.display()))
}

pub fn read(files: &dyn Files, path: &Path) -> Result<Vec<u8>, Failure> {
    files.read(path).map_err(|e| Failure::unreadable(path, &e))
}

/// The text of a file, without a byte order mark.
pub fn read_text(files: &dyn Files, path: &Path) -> Result<String, Failure> {
    let bytes = read(files, path)?;
    let text = text::decode(&bytes).map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))?;
    Ok(text.to_owned())
}

/// Width and height of a picture, which is not decoded.
pub fn picture_size(files: &dyn Files, path: &Path, camera: &str) -> Result<[u32; 2], Failure> {
    Picture::size(&read(files, path)?).map_err(|problem| failure(path, camera, &problem))
}

fn ends_in(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|extension| extensions.iter().any(|known| extension.eq_ignore_ascii_case(known)))
}

/// Whether a path has the extension of a picture that can be read.
pub fn is_picture(path: &Path) -> bool {
    ends_in(path, &EXTENSIONS)
}

/// Whether a path has the extension of a video.
pub fn is_video(path: &Path) -> bool {
    ends_in(path, &VIDEOS)
}

/// The video of this name, without extension, in the first folder that contains one. The letter case of the extension does not
/// matter.
pub fn find_video(files: &dyn Files, folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    let is_wanted =
        |path: &PathBuf| is_video(path) && path.file_stem().is_some_and(|stem| stem == name) && files.is_file(path);
    let list = |folder: &PathBuf| if files.is_folder(folder) { files.list(folder).ok() } else { None };
    folders.iter().filter_map(list).find_map(|entries| entries.into_iter().find(is_wanted))
}

/// A path without the extension of a picture. Any other dot is part of the name.
pub fn without_extension(path: &str) -> &str {
    match path.rsplit_once('.') {
        Some((stem, extension)) if EXTENSIONS.iter().any(|known| extension.eq_ignore_ascii_case(known)) => stem,
        _ => path,
    }
}

/// The file of this name, with or without the extension of a picture, in the first folder that contains one. The letter
/// case of the extension does not matter, and `\` separates folders as `/` does.
pub fn find_picture(files: &dyn Files, folders: &[PathBuf], name: &str) -> Option<PathBuf> {
    let slashes = name.replace('\\', "/");
    let names: &[&str] = if slashes == name { &[name] } else { &[name, &slashes] };
    let spelled = |folder: &PathBuf, name: &str| {
        let exact = ["", ".png", ".jpg", ".jpeg"].map(|extension| folder.join(format!("{name}{extension}")));
        exact.into_iter().find(|path| files.is_file(path)).or_else(|| in_any_case(files, &folder.join(name)))
    };
    folders.iter().find_map(|folder| names.iter().find_map(|name| spelled(folder, name)))
}

/// The file of this path, whose extension may be missing or in another letter case.
fn in_any_case(files: &dyn Files, path: &Path) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let folder = path.parent()?;
    if !files.is_folder(folder) {
        return None;
    }
    let entries = files.list(folder).ok()?;
    let matching = |wanted: &dyn Fn(&str, &str) -> bool| {
        entries.iter().find(|entry| {
            let entry_name = entry.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            let stem = without_extension(entry_name);
            stem != entry_name && wanted(entry_name, stem) && files.is_file(entry)
        })
    };
    let stem = without_extension(name);
    let found = matching(&|entry, of_entry| stem != name && of_entry == stem && entry.eq_ignore_ascii_case(name))
        .or_else(|| matching(&|_, of_entry| of_entry == name));
    found.map(|entry| folder.join(entry.file_name().unwrap_or_default()))
}

/// A mask in a folder `masks`: in the folder of the pictures, next to it, or in the capture's folder. It has the stem of
/// the picture, or the picture's full name with another extension added. Sub-folders of the pictures may be repeated below
/// `masks`; such a mask has precedence. The mask of a video is a video of the same name, in any container.
pub fn usual_mask(files: &dyn Files, capture: &Path, image: &Path) -> Option<PathBuf> {
    let capture = if files.is_folder(capture) { capture } else { capture.parent()? };
    let find = |folder: PathBuf, name: &Path| {
        if is_video(name) {
            let folder = folder.join(name.parent().unwrap_or(Path::new("")));
            return find_video(files, &[folder], &name.file_stem()?.to_string_lossy());
        }
        let full = name.to_string_lossy();
        let folder = [folder];
        find_picture(files, &folder, without_extension(&full)).or_else(|| find_picture(files, &folder, &full))
    };
    // From `capture/images/left/0.png`: capture/masks/images/left/0, capture/masks/left/0, ... and capture/masks/0.
    let above = image.ancestors().skip(1).take_while(|folder| folder.starts_with(capture)).collect::<Vec<_>>();
    for folder in above.iter().rev() {
        let relative = image.strip_prefix(folder).ok()?;
        let mut part = relative.components();
        while part.as_path().components().count() > 1 {
            if let Some(mask) = find(folder.join("masks"), part.as_path()) {
                return Some(mask);
            }
            part.next();
        }
    }
    let folder = image.parent()?;
    let beside = folder.parent().unwrap_or(folder);
    [folder, beside, capture].into_iter().find_map(|f| find(f.join("masks"), Path::new(image.file_name()?)))
}
