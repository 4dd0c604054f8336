//! Marks in names that tell cameras from each other: left and right, or a number.

use super::{
    instants::frame_folders,
    lens::plain,
    source::{is_picture, is_video, without_extension},
};
use crate::files::Files;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

/// Which camera a name means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    Left,
    Right,
    Number(u32),
}

/// What the names of cameras and their pictures have besides the mark.
const FORMS: [&str; 9] = ["", "cam", "camera", "image", "img", "view", "video", "photo", "picture"];

/// The mark of a name, and the rest of the name in lower-case letters: `Cam_01` gives `cam` and 1.
pub fn split(name: &str) -> Option<(String, Mark)> {
    let digits: Vec<&str> = name.split(|c: char| !c.is_ascii_digit()).filter(|part| !part.is_empty()).collect();
    let name = plain(name);
    match digits[..] {
        [] => {}
        [digits] => return Some((name.replace(digits, ""), Mark::Number(digits.parse().ok()?))),
        _ => return None,
    }
    let without = |word: &str| name.strip_prefix(word).or_else(|| name.strip_suffix(word));
    // A word has precedence over a letter.
    let (rest, mark) = match (without("left"), without("right")) {
        (Some(rest), None) => (rest, Mark::Left),
        (None, Some(rest)) => (rest, Mark::Right),
        (Some(_), Some(_)) => return None,
        (None, None) => {
            let left = name.strip_suffix('l').map(|rest| (rest, Mark::Left));
            left.or_else(|| name.strip_suffix('r').map(|rest| (rest, Mark::Right)))?
        }
    };
    Some((rest.to_owned(), mark))
}

/// The mark of a camera's name, such as `left`, `cam2` or `Camera_02`.
pub fn of_camera(name: &str) -> Option<Mark> {
    split(name).filter(|(form, _)| FORMS.contains(&form.as_str())).map(|(_, mark)| mark)
}

/// The names of the pictures, or of the folders or videos, of cameras with these marks. `others` are marks that the pictures
/// may have instead.
pub fn picture_names(
    files: &dyn Files,
    folder: &Path,
    marks: &[Mark],
    others: &[Vec<Mark>],
) -> Result<Vec<String>, String> {
    let mut forms: BTreeMap<String, BTreeMap<Mark, BTreeSet<String>>> = BTreeMap::new();
    for name in names(files, folder) {
        if let Some((form, mark)) = split(&name).filter(|(form, _)| FORMS.contains(&form.as_str())) {
            forms.entry(form).or_default().entry(mark).or_default().insert(name);
        }
    }
    let mut found = Vec::new();
    for wanted in std::iter::once(marks).chain(others.iter().map(Vec::as_slice)) {
        for names in forms.values() {
            let of_all: Option<Vec<&BTreeSet<String>>> = wanted.iter().map(|mark| names.get(mark)).collect();
            found.extend(of_all);
        }
    }
    let usual = |mark: &Mark| match mark {
        Mark::Left => String::from("left"),
        Mark::Right => String::from("right"),
        Mark::Number(number) => format!("cam{number}"),
    };
    let wanted = marks.iter().map(|mark| format!("`{}`", usual(mark))).collect::<Vec<_>>().join(", ");
    let remedy = format!("put pictures, folders of pictures or videos with the names {wanted} in `images`");
    match &found[..] {
        [names] if names.iter().all(|names| names.len() == 1) => {
            Ok(names.iter().filter_map(|names| names.first().cloned()).collect())
        }
        [] => Err(format!("the pictures of its cameras are missing: {remedy}")),
        several => {
            let all: Vec<String> = several.iter().flatten().flat_map(|names| names.iter()).cloned().collect();
            let all = super::keys::listed(all.iter().map(String::as_str));
            Err(format!("{all} may all be the pictures of its cameras: {remedy}, and move the others away"))
        }
    }
}

/// Names of the pictures and videos, without extensions, and of the folders that may hold those of a camera.
fn names(files: &dyn Files, folder: &Path) -> BTreeSet<String> {
    let mut folders = vec![folder.to_path_buf(), folder.join("images"), folder.join("videos")];
    folders
        .extend(folders.clone().iter().filter_map(|folder| Some(frame_folders(files, folder).into_iter().next()?.0)));
    let list = |folder: &PathBuf| if files.is_folder(folder) { files.list(folder).ok() } else { None };
    let name = |path: PathBuf| {
        let whole = path.file_name()?.to_str()?.to_owned();
        if is_picture(&path) {
            Some(without_extension(&whole).to_owned())
        } else if is_video(&path) {
            path.file_stem()?.to_str().map(str::to_owned)
        } else {
            Some(whole).filter(|_| files.is_folder(&path))
        }
    };
    folders.iter().filter_map(list).flatten().filter_map(name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_words_letters_and_numbers() {
        for (name, form, mark) in [
            ("left", "", Mark::Left),
            ("Right_Image", "image", Mark::Right),
            ("cameraMatrixL", "cameramatrix", Mark::Left),
            ("camera_matrix_right", "cameramatrix", Mark::Right),
            ("Dr", "d", Mark::Right),
            ("Cam_01", "cam", Mark::Number(1)),
            ("cam2_K", "camk", Mark::Number(2)),
        ] {
            assert_eq!(split(name), Some((form.to_owned(), mark)), "{name}");
        }
        for name in ["cam1_2", "left_right", "middle", "", "99999999999"] {
            assert_eq!(split(name), None, "{name}");
        }
        assert_eq!([of_camera("camera 3"), of_camera("board3")], [Some(Mark::Number(3)), None]);
    }
}
