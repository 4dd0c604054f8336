//! MVSNet's `cams/N_cam.txt`: `extrinsic` with a matrix of 4 x 4 numbers, world to camera, `intrinsic` with K, and a range
//! of depths. The pictures `N` are in `images`. The first pixel's centre is taken to be at (0, 0).

use super::{
    found::Found,
    notes::Notes,
    source::{failure, read_text},
    view::{ImportedView, rows},
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::Lens;
use std::path::{Path, PathBuf};

/// The end of the files' names.
pub const END: &str = "_cam.txt";

/// The files of a folder, or of its folder `cams`.
pub fn files_of(files: &dyn Files, path: &Path) -> Vec<PathBuf> {
    let of = |folder: &Path| -> Vec<PathBuf> {
        let entries = files.list(folder).unwrap_or_default();
        entries.into_iter().filter(|path| path.to_string_lossy().ends_with(END)).collect()
    };
    let own = if files.is_folder(path) { of(path) } else { Vec::new() };
    let below = path.join("cams");
    if own.is_empty() && files.is_folder(&below) { of(&below) } else { own }
}

/// Reads all files of a folder. One of the files stands for its folder.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let path = if files.is_folder(path) { path } else { path.parent().unwrap_or(Path::new("")) };
    let cameras = files_of(files, path);
    if cameras.is_empty() {
        return Err(Failure::Input(format!("{}: contains no *{END}: name the folder `cams`", path.display())));
    }
    let mut views = Vec::new();
    for file in cameras {
        let full = file.file_name().unwrap_or_default().to_string_lossy();
        let name = full.strip_suffix(END).unwrap_or(&full).to_owned();
        let wrong = |problem: String| failure(&file, &name, &problem);
        let [r, t, k] = camera(&read_text(files, &file)?).map_err(wrong)?;
        let folder = file.parent().unwrap_or(Path::new(""));
        let above = folder.parent().unwrap_or(folder);
        let folders = [folder, above].map(|folder| folder.join("images"));
        let found = Found {
            name: name.clone(),
            picture: name.clone(),
            size: None,
            k: rows(k),
            lens: Lens::NONE,
            r: rows(r),
            t: [t[0], t[1], t[2]],
        };
        views.extend(found.views(files, &file, &folders, notes)?);
    }
    notes.add(format!(
        "{}: K is taken as OpenCV's, which puts the centre of the first pixel at (0, 0); ranges of depths are ignored",
        path.display()
    ));
    Ok(views)
}

/// R, t (and zeros) and K.
fn camera(text: &str) -> Result<[[f64; 9]; 3], String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let after = |key: &str, count: usize| -> Result<Vec<f64>, String> {
        let place = words.iter().position(|&word| word == key);
        let place = place.ok_or_else(|| format!("the word `{key}` is missing: export the file again"))?;
        let numbers = words[place + 1..].iter().map_while(|word| word.parse().ok()).take(count).collect::<Vec<f64>>();
        if numbers.len() == count { Ok(numbers) } else { Err(format!("{key} needs {count} numbers: export it again")) }
    };
    let e = after("extrinsic", 16)?;
    if e[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(String::from(
            "extrinsic must have 0 0 0 1 in its last row: it may be transposed, export it by rows",
        ));
    }
    let k = after("intrinsic", 9)?;
    Ok([
        [e[0], e[1], e[2], e[4], e[5], e[6], e[8], e[9], e[10]],
        [e[3], e[7], e[11], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        std::array::from_fn(|i| k[i]),
    ])
}
