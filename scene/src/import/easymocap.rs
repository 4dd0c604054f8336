//! EasyMocap's intri.yml and extri.yml, also those of EasyVolcap and other programs that write them: OpenCV's FileStorage
//! with a list `names`, and for every name N the keys `K_N`, `dist_N` (or `D_N`), `W_N`, `H_N` in the first file, and
//! `Rot_N` (a matrix), `R_N` (Rodrigues' vector) and `T_N` in the second. World to camera and the centre of the first pixel
//! follow the convention of a scene. A camera has a picture `images/N`, or a folder of that name with one per instant.

use super::{
    found::Found,
    keys::{listed, unread},
    lens,
    notes::Notes,
    opencv_storage,
    source::failure,
    values::{self, Levels, find, number, numbers, text, to_array},
    view::{ImportedView, rotation, rows},
};
use crate::{failure::Failure, files::Files};
use serde_json::{Map, Value};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// The two files.
const FILES: [&str; 2] = ["intri.yml", "extri.yml"];
const DISTORTION: &[&str] = &["dist", "D"];
const KEYS: &[&str] = &["K", "dist", "D", "H", "W", "R", "Rot", "T"];
/// Bounds of the subject, a colour matrix and a time, which do not change the geometry.
const HARMLESS: &[&str] = &["n", "f", "bounds", "ccm", "t"];

type Object = Map<String, Value>;

/// Reads a folder with both files, or one of them.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let folder = if files.is_folder(path) { path } else { path.parent().unwrap_or(Path::new("")) };
    let [intri, extri] = files_of(files, folder);
    let mut cameras: Vec<(String, Object)> = Vec::new();
    let both = [(&intri, opencv_storage::read(files, &intri)?), (&extri, opencv_storage::read(files, &extri)?)];
    for (file, value) in &both {
        names(value).and_then(|names| add_names(&mut cameras, names)).map_err(|problem| wrong(file, &problem))?;
    }
    let mut shared = Object::new();
    for (file, value) in &both {
        let mut rest = sort(value, &mut cameras).map_err(|problem| wrong(file, &problem))?;
        let others = take_others(&mut rest);
        if !others.is_empty() {
            notes.add(format!(
                "{}: cameras are left out, because `names` does not have them: {}",
                file.display(),
                listed(others.iter().map(String::as_str))
            ));
        }
        lens::model(&rest).map_err(|problem| wrong(file, &problem))?;
        let ignored = unread(&rest, &[&["names"]], &[]).map_err(|problem| wrong(file, &problem))?;
        if !ignored.is_empty() {
            notes.add(format!("{}: ignored: {}", file.display(), listed(ignored)));
        }
        shared.extend(rest);
    }
    let folders = [folder.to_path_buf(), folder.join("images")];
    let mut views = Vec::new();
    for (name, keys) in &cameras {
        let levels = Levels(vec![keys, &shared]);
        let found = camera(name, &levels, &intri, notes).map_err(|problem| failure(&intri, name, &problem))?;
        views.extend(found.views(files, &intri, &folders, notes)?);
    }
    Ok(views)
}

/// The two files of a folder, in any letter case, and with the longer extension, too.
fn files_of(files: &dyn Files, folder: &Path) -> [PathBuf; 2] {
    let entries = files.list(folder).unwrap_or_default();
    FILES.map(|name| {
        let found = entries.iter().find(|path| part_of(path) == Some(name));
        found.cloned().unwrap_or_else(|| folder.join(name))
    })
}

/// Which of the two files a path names, if it does.
pub fn part_of(path: &Path) -> Option<&'static str> {
    let name = path.file_name()?.to_str()?.to_lowercase();
    FILES.into_iter().find(|file| name == *file || name.strip_suffix(".yaml") == file.strip_suffix(".yml"))
}

fn wrong(file: &Path, problem: &str) -> Failure {
    Failure::Input(format!("{}: {problem}", file.display()))
}

/// The names of the cameras: the list `names`, or else those with a key `K_N` or `T_N`.
fn names(value: &Value) -> Result<Vec<String>, String> {
    let top = value.as_object().ok_or("is not a map of keys and values")?;
    match top.get("names") {
        Some(Value::Array(names)) => {
            names.iter().map(|name| text(name).ok_or_else(|| format!("names: `{name}` is not a name"))).collect()
        }
        _ => Ok(top
            .keys()
            .filter_map(|key| Some(key.strip_prefix("K_").or(key.strip_prefix("T_"))?.to_owned()))
            .collect()),
    }
}

fn add_names(cameras: &mut Vec<(String, Object)>, names: Vec<String>) -> Result<(), String> {
    for (i, name) in names.iter().enumerate() {
        if names[..i].contains(name) {
            return Err(format!("names: `{name}` occurs twice: give every camera its own name"));
        }
    }
    for name in names {
        if cameras.iter().all(|(known, _)| *known != name) {
            cameras.push((name, Object::new()));
        }
    }
    Ok(())
}

/// Gives every camera its keys without its name. Returns the keys of none.
fn sort(value: &Value, cameras: &mut [(String, Object)]) -> Result<Object, String> {
    let mut rest = Object::new();
    for (key, value) in value.as_object().into_iter().flatten() {
        let of = |name: &str| key.strip_suffix(name).and_then(|prefix| prefix.strip_suffix('_')).map(str::to_owned);
        // One name may be the end of another.
        let owner = cameras.iter_mut().filter(|(name, _)| of(name).is_some()).max_by_key(|(name, _)| name.len());
        match owner {
            Some((name, keys)) => {
                let other = keys.insert(of(name).unwrap_or_default(), value.clone());
                if other.is_some_and(|other| other != *value) {
                    return Err(format!("`{key}` differs from that in {}: remove the one that is wrong", FILES[0]));
                }
            }
            None => drop(rest.insert(key.clone(), value.clone())),
        }
    }
    Ok(rest)
}

/// Takes away the keys of cameras that are not in the list of names, and returns their names.
fn take_others(rest: &mut Object) -> BTreeSet<String> {
    let name = |key: &String| Some(key.strip_prefix("K_").or(key.strip_prefix("T_"))?.to_owned());
    let others: BTreeSet<String> = rest.keys().filter_map(name).collect();
    rest.retain(|key, _| key.split_once('_').is_none_or(|(_, name)| !others.contains(name)));
    others
}

/// A camera from its own keys, and those of all cameras.
fn camera(name: &str, levels: &Levels, file: &Path, notes: &mut Notes) -> Result<Found, String> {
    let keys = levels.0[0];
    let ignored = unread(keys, &[KEYS], HARMLESS)?;
    if !ignored.is_empty() {
        notes.add(format!("{}: ignored of every camera: {}", file.display(), listed(ignored)));
    }
    let list = |key: &str, place: usize| -> Result<Vec<f64>, String> {
        let value = keys.get(key).ok_or_else(|| format!("`{key}_{name}` is missing in {}: add it", FILES[place]))?;
        numbers(value).map_err(|problem| format!("{key}_{name}: {problem}"))
    };
    let model = lens::of_levels(levels)?;
    let lens = match find(keys, DISTORTION) {
        Some((key, value)) => lens::from_list(&key, &numbers(value)?, model)?,
        None => lens::plainest(model),
    };
    let size = match (keys.get("W"), keys.get("H")) {
        (Some(w), Some(h)) => Some(values::size(number("W", w)?, number("H", h)?)?),
        (None, None) => None,
        _ => return Err(format!("W_{name} and H_{name} are needed together: add the other, or remove both")),
    };
    let r = match (keys.contains_key("Rot"), keys.contains_key("R")) {
        (true, false) => rotation(&list("Rot", 1)?)?,
        (true, true) => {
            let [matrix, vector] = [rotation(&list("Rot", 1)?)?, rotation(&list("R", 1)?)?];
            let off = matrix.as_flattened().iter().zip(vector.as_flattened()).map(|(a, b)| (a - b).abs());
            if !(off.fold(0.0, f64::max) < 1e-4) {
                return Err(format!("Rot_{name} and R_{name} are different rotations: remove the one that is wrong"));
            }
            matrix
        }
        _ => rotation(&list("R", 1)?)?,
    };
    Ok(Found {
        name: name.to_owned(),
        picture: name.to_owned(),
        size,
        k: to_array(&list("K", 0)?, "K").map(rows)?,
        lens,
        r,
        t: to_array(&list("T", 1)?, "T")?,
    })
}
