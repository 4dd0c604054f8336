//! OpenCV calibrations in YAML, JSON or XML, as FileStorage writes them. World to camera and the centre of the first pixel
//! follow the convention of a scene.
//!
//! A file contains one camera, or several as a list or map `cameras` or as named maps. Keys beside the cameras apply to
//! all of them. A folder contains one file per camera. Of the keys below, the first that exists is used. Letter case and
//! underscores do not matter in those with more than two letters.
//! - K: `camera_matrix`, `cameraMatrix`, `K`, `intrinsic_matrix`, `mtx`
//! - distortion k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, or k1 k2 k3 k4 if a key says that the lens is a fisheye:
//!   `distortion_coefficients`, `distCoeffs`, `dist_coeffs`, `D`, `distortion`, or each by its name; default: zero
//! - rotation, as a 3x3 matrix or Rodrigues' vector: `R`, `rotation_matrix`, `rotation`, `rvec`,
//!   `rotation_vector`
//! - translation: `t`, `tvec`, `T`, `translation`, `translation_vector`
//! - size: `image_width` and `image_height`, `width` and `height`, or `image_size`; default: the size of the picture
//! - name: `name`; default: the key in the map, or the stem of the file
//! - picture: `image`, `image_path`, `file`; default: a picture with the camera's name, in this folder or in `images`, or a
//!   folder of that name with one per instant
//! - mask: `mask`, `mask_path`; default: searched for in `masks`
//!
//! Stereo pairs have other keys ([`super::opencv_pair`]).

use super::{
    found::Found,
    keys::unread,
    lens,
    notes::Notes,
    opencv_contents::{Contents, has_camera, note_unread},
    opencv_keys::{
        DISTORTION, HARMLESS, IMAGE, K, MASK, Object, ROTATION, SIZE, SIZES, TRANSLATION, as_map, check_matrices,
        spelled,
    },
    opencv_storage,
    source::{failure, find_picture},
    values::{self, Levels, find, numbers, text, to_array},
    view::{ImportedView, rotation, rows},
};
#[cfg(feature = "formats")]
use super::{opencv_pair, opencv_part};
use crate::{failure::Failure, files::Files};
use pcmvs_core::Lens;
use serde_json::Map;
#[cfg(feature = "formats")]
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Reads a file, or all YAML, JSON and XML files of a folder that contain a camera.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let mut views = Vec::new();
    let load = |file: PathBuf| Ok((file.clone(), spelled(opencv_storage::read(files, &file)?)));
    let read = calibrations(files, path)?.into_iter().map(load).collect::<Result<Vec<_>, Failure>>()?;
    #[cfg(feature = "formats")]
    let read = opencv_pair::join(files, read, || beside(files, path), notes)?;
    for (file, value) in read {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
        let contents = Contents::new(&value, stem).map_err(wrong)?;
        if contents.cameras.is_empty() {
            let top = value.as_object();
            check_pair(top).map_err(wrong)?;
            let parts = [DISTORTION, ROTATION, TRANSLATION];
            if let Some((key, _)) = top.and_then(|top| parts.iter().find_map(|keys| find(top, keys))) {
                return Err(wrong(format!("has `{key}`, but none of the keys {K:?}: add K, or move the file away")));
            }
            for keys in top.into_iter().chain(top.into_iter().flat_map(Map::values).filter_map(as_map)) {
                unread(keys, &[], HARMLESS).map_err(wrong)?;
                check_matrices(keys).map_err(wrong)?;
            }
            notes.add(format!("{}: contains no camera and is ignored", file.display()));
            continue;
        }
        contents.check_shared(&file, notes).map_err(wrong)?;
        for (name, own) in &contents.cameras {
            views.extend(camera(files, &file, name, own, &contents.shared, notes)?);
        }
    }
    if views.is_empty() {
        return Err(Failure::Input(format!("{}: contains no camera: one of the keys {K:?} is needed", path.display())));
    }
    Ok(views)
}

fn calibrations(files: &dyn Files, path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !files.is_folder(path) {
        return Ok(vec![path.to_path_buf()]);
    }
    let has = |file: &Path, ends: &[&str]| {
        file.extension().is_some_and(|e| ends.iter().any(|known| e.eq_ignore_ascii_case(known)))
    };
    let known = |file: &PathBuf| {
        has(file, &["yml", "yaml", "json"]) || has(file, &["xml"]) && opencv_storage::is_xml(files, file)
    };
    let entries = files.list(path).map_err(|e| Failure::unreadable(path, &e))?;
    Ok(entries.into_iter().filter(known).collect())
}

/// The other calibrations in the folder of a file. What cannot be read is none.
#[cfg(feature = "formats")]
fn beside(files: &dyn Files, path: &Path) -> Result<Vec<(PathBuf, Value)>, Failure> {
    if files.is_folder(path) {
        return Ok(Vec::new());
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let others = calibrations(files, folder)?.into_iter().filter(|file| file.file_name() != path.file_name());
    Ok(others.filter_map(|file| Some((file.clone(), spelled(opencv_storage::read(files, &file).ok()?)))).collect())
}

/// Whether a file has a camera, and nothing else is known of it.
pub fn is_camera_file(files: &dyn Files, file: &Path) -> bool {
    let Ok(value) = opencv_storage::read(files, file) else { return false };
    let value = spelled(value);
    #[cfg(feature = "formats")]
    if opencv_part::has_lens(&value) {
        return true;
    }
    has_camera(&value)
}

/// Refuses a stereo pair that is not read as one: it has one pose for two cameras.
fn check_pair(top: Option<&Object>) -> Result<(), String> {
    let numbered = ["M", "K", "cameraMatrix", "camera_matrix", "CM"].map(|key| [format!("{key}1"), format!("{key}2")]);
    match top.and_then(|top| numbered.iter().find(|pair| pair.iter().all(|key| top.contains_key(key)))) {
        Some([first, second]) => Err(format!(
            "has two cameras, `{first}` and `{second}`, of a stereo pair, whose R and t lead from one to the other: write one \
             camera per file or per map, each with its own pose, world to camera"
        )),
        None => Ok(()),
    }
}

/// The views of a camera: one per picture.
fn camera(
    files: &dyn Files,
    file: &Path,
    name: &str,
    own: &Object,
    shared: &Object,
    notes: &mut Notes,
) -> Result<Vec<ImportedView>, Failure> {
    let wrong = |problem: String| failure(file, name, &problem);
    lens::model(own).map_err(wrong)?;
    note_unread(own, file, notes).map_err(wrong)?;
    let levels = Levels(vec![own, shared]);
    let folder = file.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_path_buf(), folder.join("images")];
    let path = |keys: &[&str]| -> Result<Option<String>, Failure> {
        let Some((key, value)) = find(own, keys) else { return Ok(None) };
        text(value).map(Some).ok_or_else(|| wrong(format!("{key} is not a path")))
    };
    let picture = path(IMAGE)?.unwrap_or_else(|| name.to_owned());
    let mask = match path(MASK)? {
        Some(mask) => Some(find_picture(files, &folders[..1], &mask).ok_or_else(|| {
            wrong(format!(
                "its mask `{mask}` is missing: correct the key `mask`, or remove it and put the mask in `masks`"
            ))
        })?),
        None => None,
    };
    let k = required(&levels, K).and_then(|n| to_array(&n, "K")).map_err(wrong)?;
    let t = required(&Levels(vec![own]), TRANSLATION).and_then(|n| to_array(&n, "t")).map_err(wrong)?;
    let found = Found {
        name: name.to_owned(),
        picture,
        size: size(&levels).map_err(wrong)?,
        k: rows(k),
        lens: distortion(&levels).map_err(wrong)?,
        r: required(&Levels(vec![own]), ROTATION).and_then(|n| rotation(&n)).map_err(wrong)?,
        t,
    };
    let mut views = found.views(files, file, &folders, notes)?;
    if mask.is_some() && views.len() > 1 {
        return Err(wrong(String::from(
            "has one mask for several pictures: remove the key `mask`, and put masks in `masks`",
        )));
    }
    for view in &mut views {
        view.mask = mask.clone();
    }
    Ok(views)
}

fn required(levels: &Levels, keys: &[&str]) -> Result<Vec<f64>, String> {
    let (key, found) = levels.find(keys).ok_or_else(|| format!("one of {keys:?} is needed"))?;
    numbers(found).map_err(|problem| format!("{key}: {problem}"))
}

fn size(levels: &Levels) -> Result<Option<[u32; 2]>, String> {
    for [width, height] in SIZES {
        match (levels.number(&[width])?, levels.number(&[height])?) {
            (Some(w), Some(h)) => return values::size(w, h).map(Some),
            (None, None) => {}
            _ => return Err(format!("{width} and {height} are needed together: add the other, or remove both")),
        }
    }
    let Some((key, pair)) = levels.find(SIZE) else { return Ok(None) };
    let [w, h] = numbers(pair).and_then(|n| to_array(&n, &key))?;
    values::size(w, h).map(Some)
}

fn distortion(levels: &Levels) -> Result<Lens, String> {
    let model = lens::of_levels(levels)?;
    let named = lens::from_names(levels, model)?;
    let Some((key, found)) = levels.find(DISTORTION) else { return Ok(named.unwrap_or(lens::plainest(model))) };
    let listed =
        numbers(found).map_err(|problem| format!("{key}: {problem}")).and_then(|n| lens::from_list(&key, &n, model))?;
    match named {
        Some(named) if named != listed => {
            Err(format!("{key} and the coefficients by name contradict each other: remove those that are wrong"))
        }
        _ => Ok(listed),
    }
}
