//! Bundler's bundle.out with list.txt: camera axes are x right, y up, z backward. The radial distortion is that of OpenCV's
//! k1 and k2. The principal point is the middle of the picture.

use super::{
    found::{Found, pictures},
    names::name_of,
    notes::Notes,
    source::{failure, picture_size, read_text},
    view::ImportedView,
};
use crate::{failure::Failure, files::Files};
use pcmvs_core::Lens;
use std::path::{Path, PathBuf};

/// Numbers of a camera: f k1 k2, R by rows, t.
const NUMBERS: usize = 15;

/// The file that a path stands for: itself, or the usual one of a folder.
pub fn file(files: &dyn Files, path: &Path) -> Option<PathBuf> {
    if files.is_file(path) {
        return Some(path.to_path_buf());
    }
    ["bundle.out", "bundle/bundle.out", "bundle.rd.out"]
        .map(|name| path.join(name))
        .into_iter()
        .find(|p| files.is_file(p))
}

/// Reads bundle.out, or a folder with it.
pub fn read(files: &dyn Files, path: &Path, notes: &mut Notes) -> Result<Vec<ImportedView>, Failure> {
    let missing = || Failure::Input(format!("{}: contains no bundle.out: name the file itself", path.display()));
    let file = file(files, path).ok_or_else(missing)?;
    let wrong = |problem: String| Failure::Input(format!("{}: {problem}", file.display()));
    let cameras = cameras(&read_text(files, &file)?).map_err(wrong)?;
    let (list, names) = list(files, &file)?;
    if names.len() != cameras.len() {
        return Err(wrong(format!(
            "has {} cameras, but {} has {} pictures: export both again",
            cameras.len(),
            list.display(),
            names.len()
        )));
    }
    let folder = list.parent().unwrap_or(Path::new(""));
    let folders = [folder.to_path_buf(), folder.join("images")];
    let mut views = Vec::new();
    for (picture, numbers) in names.iter().zip(cameras) {
        let name = name_of(picture);
        let [f, k1, k2, r @ .., tx, ty, tz] = numbers;
        if f == 0.0 {
            notes.add(format!("camera `{name}`: {}: has no pose and is left out", file.display()));
            continue;
        }
        let found = pictures(files, &folders, picture)?;
        let (image, _) = found.first().ok_or_else(|| {
            failure(&list, &name, &format!("its picture `{picture}` is missing: put it beside the list or in `images`"))
        })?;
        let size = picture_size(files, image, &name)?;
        let [cx, cy] = size.map(|side| 0.5 * f64::from(side) - 0.5);
        let found = Found {
            name: name.clone(),
            picture: picture.clone(),
            size: Some(size),
            k: [[f, 0.0, cx], [0.0, f, cy], [0.0, 0.0, 1.0]],
            lens: Lens::brown([k1, k2, 0.0, 0.0, 0.0]),
            // y and z point the other way in a scene.
            r: [[r[0], r[1], r[2]], [-r[3], -r[4], -r[5]], [-r[6], -r[7], -r[8]]],
            t: [tx, -ty, -tz],
        };
        views.extend(found.views(files, &file, &folders, notes)?);
    }
    Ok(views)
}

/// The numbers of all cameras. Points follow them, which are not read.
fn cameras(text: &str) -> Result<Vec<[f64; NUMBERS]>, String> {
    let mut words = text.lines().filter(|line| !line.trim_start().starts_with('#')).flat_map(str::split_whitespace);
    let mut next = || -> Result<f64, String> {
        let word = words.next().ok_or("the file is truncated: copy it again")?;
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            _ => Err(format!("`{word}` is not a finite number")),
        }
    };
    let (count, _points) = (next()?, next()?);
    let mut cameras = Vec::new();
    while (cameras.len() as f64) < count {
        let mut numbers = [0.0; NUMBERS];
        for number in &mut numbers {
            *number = next()?;
        }
        cameras.push(numbers);
    }
    Ok(cameras)
}

/// The file with the names of the pictures, one a line, and these names.
fn list(files: &dyn Files, file: &Path) -> Result<(PathBuf, Vec<String>), Failure> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let own = format!("{stem}.list.txt");
    let above = folder.parent().unwrap_or(folder);
    let places = [folder.join(own), folder.join("list.txt"), above.join("list.txt")];
    let Some(list) = places.into_iter().find(|path| files.is_file(path)) else {
        return Err(Failure::Input(format!(
            "{}: list.txt with the names of the pictures is missing: put it beside this file",
            file.display()
        )));
    };
    let text = read_text(files, &list)?;
    let names = text.lines().map(str::trim).filter(|line| !line.is_empty()).map(|line| name(line).to_owned()).collect();
    Ok((list, names))
}

/// The name in a line: a picture, perhaps followed by 0 and a focal length.
fn name(line: &str) -> &str {
    let shorter = line.rsplit_once(char::is_whitespace).and_then(|(rest, last)| {
        let (name, zero) = rest.trim_end().rsplit_once(char::is_whitespace)?;
        (zero == "0" && last.parse::<f64>().is_ok()).then_some(name.trim_end())
    });
    shorter.unwrap_or(line)
}
