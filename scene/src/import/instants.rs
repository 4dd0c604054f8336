//! Pictures of several instants, by the usual folders: one per camera, with numbered pictures, or one per instant, with one
//! picture per camera.

use super::{source::is_picture, view::ImportedView};
use crate::{failure::Failure, files::Files};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// What the names of folders of instants have before their number.
const FRAME: [&str; 7] = ["", "f", "frame", "frame_", "frame-", "t", "time"];

/// A name without the number at its end, and that number.
fn split(name: &str) -> Option<(&str, f64)> {
    let digits = name.len() - name.bytes().rev().take_while(u8::is_ascii_digit).count();
    Some((&name[..digits], name[digits..].parse().ok()?))
}

fn name(path: &Path) -> &str {
    path.file_name().and_then(|name| name.to_str()).unwrap_or_default()
}

/// A picture's name without number and extension, and the number.
fn split_picture(path: &Path) -> Option<(&str, f64)> {
    split(path.file_stem()?.to_str()?)
}

/// The pictures of a folder, with the numbers at the end of their names. Without a number, a picture must be the only one, and
/// two must not have the same.
pub fn numbered(files: &dyn Files, folder: &Path) -> Result<Vec<(PathBuf, Option<f64>)>, Failure> {
    let entries = files.list(folder).map_err(|e| Failure::unreadable(folder, &e))?;
    let pictures: Vec<PathBuf> = entries.into_iter().filter(|path| files.is_file(path) && is_picture(path)).collect();
    let several = pictures.len() > 1;
    let mut seen: BTreeMap<u64, PathBuf> = BTreeMap::new();
    let number = |path: PathBuf| {
        let number = split_picture(&path).map(|(_, number)| number);
        let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
        if several && number.is_none() {
            return Err(wrong(String::from(
                "is one of several pictures of its camera, but its name does not end in the number of a frame: rename it, or \
                 move it away",
            )));
        }
        if let Some(other) = number.and_then(|number| seen.insert(number.to_bits(), path.clone())) {
            return Err(wrong(format!("has the same number as {}: remove one of them", name(&other))));
        }
        Ok((path, number))
    };
    pictures.into_iter().map(number).collect()
}

/// The folders of instants in a folder, such as 000012 or frame_12, with their numbers.
pub fn frame_folders(files: &dyn Files, folder: &Path) -> Vec<(PathBuf, f64)> {
    let entries = if files.is_folder(folder) { files.list(folder).unwrap_or_default() } else { Vec::new() };
    let frame = |path: PathBuf| {
        let (_, number) = split(name(&path)).filter(|(before, _)| is_frame(before))?;
        files.is_folder(&path).then_some((path, number))
    };
    entries.into_iter().filter_map(frame).collect()
}

fn is_frame(before: &str) -> bool {
    FRAME.iter().any(|known| before.eq_ignore_ascii_case(known))
}

/// A way in which pictures of several instants are usually arranged.
#[derive(Clone, Copy)]
enum Layout {
    FolderPerCamera,
    FolderPerInstant,
}

impl Layout {
    /// What the pictures of one camera have in common, and the number of this one's instant.
    fn place(self, image: &Path) -> Option<(PathBuf, f64)> {
        let folder = image.parent()?;
        match self {
            Self::FolderPerCamera => {
                let (before, number) = split_picture(image)?;
                Some((folder.join(before), number))
            }
            Self::FolderPerInstant => {
                let (before, number) = split(name(folder)).filter(|(before, _)| is_frame(before))?;
                Some((folder.with_file_name(before).join(name(image)), number))
            }
        }
    }

    /// The pictures that are arranged with this one, of any instant.
    fn others(self, files: &dyn Files, image: &Path) -> Vec<PathBuf> {
        let Some(folder) = image.parent() else { return Vec::new() };
        let all: Vec<PathBuf> = match self {
            Self::FolderPerCamera => files.list(folder).unwrap_or_default(),
            Self::FolderPerInstant => frame_folders(files, folder.parent().unwrap_or(Path::new("")))
                .into_iter()
                .map(|(frame, _)| frame.join(name(image)))
                .collect(),
        };
        let own = self.place(image).map(|(camera, _)| camera);
        let is_other = |path: &PathBuf| {
            path.extension() == image.extension()
                && self.place(path).map(|(camera, _)| camera) == own
                && files.is_file(path)
        };
        all.into_iter().filter(is_other).collect()
    }

    /// The name of the camera, without the number of the instant.
    fn camera_name(self, view: &ImportedView) -> String {
        let whole = view.name.as_str();
        let short = match self {
            Self::FolderPerCamera => view.image.file_stem().and_then(|stem| whole.strip_suffix(stem.to_str()?)),
            Self::FolderPerInstant => view.image.parent().and_then(|folder| whole.strip_prefix(name(folder))),
        };
        let short = short.unwrap_or(whole).trim_matches(['_', '-', '.']);
        String::from(if short.is_empty() { whole } else { short })
    }
}

/// Views of a calibration that knows of no time become a clip if their pictures are arranged as those of several instants:
/// those of the same camera get the numbers of their instants as times, and pictures beside them that the calibration does not
/// name are added. Only folders inside `capture` are searched.
pub fn find(files: &dyn Files, capture: &Path, views: Vec<ImportedView>) -> Vec<ImportedView> {
    if views.iter().any(|view| view.time.is_some()) {
        return views;
    }
    let layouts = [Layout::FolderPerCamera, Layout::FolderPerInstant];
    layouts.into_iter().find_map(|layout| clip(files, capture, &views, layout)).unwrap_or(views)
}

fn clip(files: &dyn Files, capture: &Path, views: &[ImportedView], layout: Layout) -> Option<Vec<ImportedView>> {
    let mut cameras: BTreeMap<PathBuf, Vec<(&ImportedView, f64)>> = BTreeMap::new();
    for view in views {
        let folder = view.image.parent()?;
        let place = layout.place(&view.image).filter(|_| folder.starts_with(capture) && folder != capture)?;
        cameras.entry(place.0).or_default().push((view, place.1));
    }
    let is_one = |own: &[(&ImportedView, f64)]| own.iter().all(|(view, _)| view.camera == own[0].0.camera);
    let folders = cameras.values().filter_map(|own| own[0].0.image.parent());
    let apart = match layout {
        Layout::FolderPerCamera => folders.collect::<std::collections::BTreeSet<_>>().len() == cameras.len(),
        Layout::FolderPerInstant => true,
    };
    if cameras.len() < 2 || !apart || !cameras.values().all(|own| is_one(own)) {
        return None;
    }
    let mut all = Vec::new();
    let mut several = false;
    // In the order of the calibration.
    let mut order: Vec<&Vec<(&ImportedView, f64)>> = cameras.values().collect();
    order.sort_by_key(|own| views.iter().position(|view| std::ptr::eq(view, own[0].0)));
    for own in order {
        let first = own[0].0;
        let camera = layout.camera_name(first);
        let known = |image: &Path| own.iter().any(|(view, _)| view.image == image);
        let added = layout.others(files, &first.image).into_iter().filter(|image| !known(image));
        let added = added.filter_map(|image| {
            let time = layout.place(&image)?.1;
            Some((ImportedView { image, mask: None, ..first.clone() }, time))
        });
        let own = own.iter().map(|(view, time)| ((*view).clone(), *time)).chain(added);
        let own: Vec<ImportedView> =
            own.map(|(view, time)| ImportedView { name: camera.clone(), time: Some(time), ..view }).collect();
        several |= own.len() > 1;
        all.extend(own);
    }
    several.then_some(all)
}
