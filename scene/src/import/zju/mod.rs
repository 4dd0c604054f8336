//! ZJU-MoCap's annots.npy, also of other data sets in its form: a dict in an array of objects. `cams` has K, D (k1 k2 p1 p2
//! k3), R and T per camera, world to camera as in a scene, but T in millimetres. `ims` has a dict per frame, whose list `ims`
//! names the pictures of the cameras in their order.

mod arrays;
mod pickle;

use super::{
    keys::{listed, unread},
    lens,
    notes::Notes,
    source::{failure, find_picture, picture_size, read},
    values::to_array,
    view::{ImportedView, rows},
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::{Camera, Lens};
use pickle::{Id, Pickle};
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// Name of the file.
pub const FILE: &str = "annots.npy";
/// What every .npy file begins with.
const MAGIC: &[u8] = b"\x93NUMPY";
const CAMERAS: &str = "cams";
const FRAMES: &str = "ims";
/// Most pictures of a file.
const MOST_PICTURES: usize = 1_000_000;
/// Folders with masks, whose values are numbers of body parts.
const LABELS: [&str; 2] = ["mask_cihp", "mask"];
const MILLIMETRES: f64 = 1000.0;

/// A camera without its size, which is that of its pictures.
struct Found {
    k: [[f64; 3]; 3],
    lens: Lens,
    r: [[f64; 3]; 3],
    t: [f64; 3],
}

/// Reads the file, or a folder with it.
pub fn import(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let file = if files.is_folder(path) { path.join(FILE) } else { path.to_path_buf() };
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
    let bytes = read(files, &file)?;
    let pickle = objects(&bytes).and_then(Pickle::read).map_err(wrong)?;
    let top = entries(&pickle, pickle.root).map_err(wrong)?;
    let mut ignored = unknown(&top, &[CAMERAS, FRAMES]).map_err(wrong)?;
    let found = cameras(&pickle, required(&top, CAMERAS).map_err(wrong)?, &mut ignored)
        .map_err(|problem| wrong(format!("{CAMERAS}: {problem}")))?;
    let frames = frames(&pickle, required(&top, FRAMES).map_err(wrong)?, found.len(), &mut ignored).map_err(wrong)?;
    if !ignored.is_empty() {
        let names = listed(ignored.iter().map(String::as_str));
        notes.add(format!("{}: ignored: {names}", file.display()));
    }
    notes.add(format!("{}: T is in millimetres, and the scene in metres", file.display()));
    let folder = file.parent().unwrap_or(Path::new(""));
    if let Some(labels) = LABELS.map(|name| folder.join(name)).iter().find(|folder| files.is_folder(folder)) {
        notes.add(format!(
            "{}: is not taken, because the values are numbers of body parts: make them white and put them in `masks`",
            labels.display()
        ));
    }
    views(files, &file, &found, &frames, notes)
}

/// The pickle of a .npy file.
fn objects(bytes: &[u8]) -> Result<&[u8], String> {
    let is_short = || String::from("ends in its header: copy the file again");
    let rest = bytes.strip_prefix(MAGIC).ok_or("is no .npy file: name an annots.npy")?;
    let (&[version, _], rest) = rest.split_first_chunk::<2>().ok_or_else(is_short)?;
    // The length has two bytes in version 1, and four later.
    let width = if version == 1 { 2 } else { 4 };
    let (length, rest) = rest.split_at_checked(width).ok_or_else(is_short)?;
    let length = length.iter().rev().fold(0, |value, &byte| value << 8 | usize::from(byte));
    let (header, data) = rest.split_at_checked(length).ok_or_else(is_short)?;
    let header = String::from_utf8_lossy(header);
    if !header.contains("'|O'") {
        return Err(String::from("is an array of numbers, not a dict with `cams` and `ims`: name an annots.npy"));
    }
    Ok(data)
}

type Entries<'a> = Vec<(&'a str, Id)>;

fn entries<'a>(pickle: &'a Pickle<'_>, id: Id) -> Result<Entries<'a>, String> {
    let entries = arrays::entries(pickle, id).ok_or("is not a dict: name an annots.npy")?;
    let key = |&(key, value): &(Id, Id)| pickle.text(key).map(|key| (key, value)).ok_or("has a key that is no text");
    Ok(entries.iter().map(key).collect::<Result<_, _>>()?)
}

/// The last value of a key, as in Python.
fn required(entries: &Entries, key: &str) -> Result<Id, String> {
    let found = entries.iter().rev().find(|(name, _)| *name == key);
    found.map(|(_, value)| *value).ok_or_else(|| format!("has no `{key}`: name an annots.npy"))
}

/// The keys that are not understood. One that looks like calibration is an error.
fn unknown(entries: &Entries, known: &[&str]) -> Result<Vec<String>, String> {
    let present: Map<String, Value> = entries.iter().map(|(key, _)| ((*key).to_owned(), Value::Bool(true))).collect();
    Ok(unread(&present, &[known], &[])?.into_iter().map(str::to_owned).collect())
}

fn cameras(pickle: &Pickle, id: Id, ignored: &mut Vec<String>) -> Result<Vec<Found>, String> {
    let keys = entries(pickle, id)?;
    ignored.extend(unknown(&keys, &["K", "D", "R", "T"])?);
    let lists = |key: &str| -> Result<Vec<Vec<f64>>, String> {
        arrays::lists(pickle, required(&keys, key)?).map_err(|problem| format!("{key} {problem}"))
    };
    let [k, d, r, t] = [lists("K")?, lists("D")?, lists("R")?, lists("T")?];
    let counts = [k.len(), d.len(), r.len(), t.len()];
    if counts.iter().any(|&count| count != k.len()) {
        return Err(format!("K, D, R and T are those of {counts:?} cameras: save the file again"));
    }
    let camera = |i: usize| -> Result<Found, String> {
        Ok(Found {
            k: to_array(&k[i], "K").map(rows)?,
            lens: lens::from_list("D", &d[i], None)?,
            r: to_array(&r[i], "R").map(rows)?,
            t: to_array::<3>(&t[i], "T")?.map(|v| v / MILLIMETRES),
        })
    };
    (0..k.len()).map(|i| camera(i).map_err(|problem| format!("camera {i}: {problem}"))).collect()
}

/// The names of the pictures of every frame, in the order of the cameras.
fn frames(pickle: &Pickle, id: Id, cameras: usize, ignored: &mut Vec<String>) -> Result<Vec<Vec<String>>, String> {
    let frames = arrays::items(pickle, id).ok_or_else(|| format!("{FRAMES} is no list"))?;
    if frames.len().saturating_mul(cameras) > MOST_PICTURES {
        return Err(format!("has more than {MOST_PICTURES} pictures: save fewer frames"));
    }
    let mut frame = |(i, &frame): (usize, &Id)| -> Result<Vec<String>, String> {
        let keys = entries(pickle, frame)?;
        if i == 0 {
            ignored.extend(unknown(&keys, &[FRAMES])?);
        }
        let names = arrays::texts(pickle, required(&keys, FRAMES)?, cameras);
        names.ok_or_else(|| format!("`{FRAMES}` is no list of {cameras} pictures, one of every camera"))
    };
    let frames = frames.iter().enumerate();
    frames.map(|entry| frame(entry).map_err(|problem| format!("{FRAMES}[{}]: {problem}", entry.0))).collect()
}

/// The folder of a picture, which has the camera's name.
fn folder_of(picture: &str) -> String {
    let slashes = picture.replace('\\', "/");
    slashes.rsplit_once('/').map_or(String::new(), |(folder, _)| folder.trim_matches('/').to_owned())
}

/// Names of the cameras: the folders of their pictures if those differ.
fn names(found: &[Found], frames: &[Vec<String>]) -> Vec<String> {
    let folders: Vec<String> = frames.first().into_iter().flatten().map(|picture| folder_of(picture)).collect();
    let are_names = folders.iter().enumerate().all(|(i, name)| !name.is_empty() && !folders[..i].contains(name));
    if are_names && folders.len() == found.len() {
        folders
    } else {
        (0..found.len()).map(|i| format!("cam{i:02}")).collect()
    }
}

fn views(
    files: &dyn Files,
    file: &Path,
    found: &[Found],
    frames: &[Vec<String>],
    notes: &mut Notes,
) -> Result<Vec<ImportedView>, Failure> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_path_buf(), folder.join("images")];
    let mut views = Vec::new();
    let (mut missing, mut example) = (0, None);
    for ((i, camera), name) in found.iter().enumerate().zip(names(found, frames)) {
        let own: Vec<(PathBuf, f64)> = frames
            .iter()
            .zip(0..)
            .filter_map(|(pictures, index)| {
                let image = find_picture(files, &folders, &pictures[i]);
                if image.is_none() {
                    missing += 1;
                    example.get_or_insert_with(|| pictures[i].clone());
                }
                Some((image?, f64::from(index)))
            })
            .collect();
        let Some((first, _)) = own.first() else {
            let picture = frames.first().map_or("", |pictures| pictures[i].as_str());
            let problem = format!("none of its pictures is there, such as `{picture}`: put them beside this file");
            return Err(failure(file, &name, &problem));
        };
        let [width, height] = picture_size(files, first, &name)?;
        let camera = Camera { width, height, k: camera.k, lens: camera.lens, r: camera.r, t: camera.t };
        views.extend(own.into_iter().map(|(image, time)| ImportedView {
            name: name.clone(),
            camera,
            file: file.to_path_buf(),
            image,
            mask: None,
            time: (frames.len() > 1).then_some(time),
        }));
    }
    if let Some(example) = example {
        let all = found.len() * frames.len();
        notes.add(format!(
            "{}: {missing} of {all} pictures are not there and left out, such as `{example}`",
            file.display()
        ));
    }
    Ok(views)
}
