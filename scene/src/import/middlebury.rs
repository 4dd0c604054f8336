//! Middlebury's `*_par.txt`: the number of views, then one line per view: name, K, R and t by rows (world to camera).

use super::{
    names::name_of,
    source::{failure, find_picture, picture_size, read_text},
    view::{ImportedView, rows},
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::{Camera, Lens};
use std::path::{Path, PathBuf};

/// Reads a folder with one `*_par.txt`, or that file. The pictures are in the same folder or in `images`.
pub fn read(files: &dyn Files, path: &Path) -> Result<Vec<ImportedView>, Failure> {
    let file = parameters(files, path)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let text = read_text(files, &file)?;
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
    let count: usize = lines
        .next()
        .and_then(|line| line.parse().ok())
        .ok_or_else(|| wrong(String::from("the first line must be the number of views")))?;
    let views: Vec<ImportedView> = lines.map(|line| view(files, &file, folder, line)).collect::<Result<_, _>>()?;
    if views.len() != count {
        return Err(wrong(format!(
            "the first line announces {count} views, but there are {}: copy the file again",
            views.len()
        )));
    }
    Ok(views)
}

fn parameters(files: &dyn Files, path: &Path) -> Result<PathBuf, Failure> {
    if !files.is_folder(path) {
        return Ok(path.to_path_buf());
    }
    let entries = files.list(path).map_err(|e| Failure::unreadable(path, &e))?;
    let mut found: Vec<PathBuf> =
        entries.into_iter().filter(|p| p.to_string_lossy().to_lowercase().ends_with("_par.txt")).collect();
    match (found.pop(), found.is_empty()) {
        (Some(file), true) => Ok(file),
        (found, _) => {
            let count = if found.is_none() { "no" } else { "more than one" };
            Err(Failure::Input(format!("{}: contains {count} *_par.txt: name the file itself", path.display())))
        }
    }
}

fn view(files: &dyn Files, file: &Path, folder: &Path, line: &str) -> Result<ImportedView, Failure> {
    // The numbers are read from the end, because a name may contain spaces.
    let mut picture = line;
    let mut n = [0.0; 21];
    let complete = n.iter_mut().rev().all(|number| {
        let Some((before, word)) = picture.rsplit_once(char::is_whitespace) else { return false };
        picture = before.trim_end();
        word.parse().map(|v| *number = v).is_ok()
    });
    let name = name_of(picture);
    // A name that starts with a number too many belongs to a line that has too many numbers.
    if !complete || picture.split_whitespace().skip(1).any(|word| word.parse::<f64>().is_ok()) {
        let name = name_of(line.split_whitespace().next().unwrap_or_default());
        return Err(failure(file, &name, "21 numbers are needed after the name: K, R and t by rows"));
    }
    let image = find_picture(files, &[folder.to_path_buf(), folder.join("images")], picture).ok_or_else(|| {
        failure(file, &name, &format!("its picture `{picture}` is missing: put it into the folder of this file"))
    })?;
    let [width, height] = picture_size(files, &image, &name)?;
    let nine = |start: usize| rows(std::array::from_fn(|i| n[start + i]));
    let camera = Camera { width, height, k: nine(0), lens: Lens::NONE, r: nine(9), t: [n[18], n[19], n[20]] };
    Ok(ImportedView { name, camera, file: file.to_path_buf(), image, mask: None, time: None })
}
