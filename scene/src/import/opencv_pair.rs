//! Stereo pairs of OpenCV: two lenses, and R and T of `stereoCalibrate`, which lead from the first camera to the second:
//! `x2 = R x1 + T`. The world is that of the first camera.
//!
//! The keys of a lens are marked by `1` and `2`, `0` and `1`, `left` and `right` or `l` and `r`: `M1 D1 M2 D2`,
//! `cameraMatrix1`, `K_left`. Lenses may also be maps with such names, or files with such names that have no pose. All may be
//! in one file, or R and T in another than the lenses. What `stereoRectify` derives from them is not read. Here pairs become
//! cameras as [`super::opencv`] reads them, each with its pose.

use super::{
    marks::{Mark, picture_names},
    notes::Notes,
    opencv_chain,
    opencv_contents::has_camera,
    opencv_keys::{IMAGE, NAME, Object},
    opencv_part::{Part, identity},
    values::{find, text},
};
use crate::{failure::Failure, files::Files};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The calibrations in which pairs have become cameras with poses. `beside` are the other files in the folder of a file that
/// the user has named.
pub fn join(
    files: &dyn Files,
    read: Vec<(PathBuf, Value)>,
    beside: impl Fn() -> Result<Vec<(PathBuf, Value)>, Failure>,
    notes: &mut Notes,
) -> Result<Vec<(PathBuf, Value)>, Failure> {
    let is_of_pair = |parts: &[Part]| {
        let any = |is: &dyn Fn(&Part) -> bool| parts.iter().any(is);
        let has_lens = |part: &Part| !part.lenses.is_empty();
        any(&|part| part.is_marked && has_lens(part)) || any(&has_lens) && any(&|part| part.pose.is_some())
    };
    let mut parts: Vec<Part> = read.iter().filter_map(|(file, value)| Part::new(file, value)).collect();
    if let [part] = &parts[..]
        && !part.is_complete()
    {
        let others: Vec<Part> = beside()?.iter().filter_map(|(file, value)| Part::new(file, value)).collect();
        let others = others.into_iter().filter(|other| !other.is_complete());
        parts.extend(others);
    }
    if !is_of_pair(&parts) {
        return Ok(read);
    }
    let rest: Vec<(PathBuf, Value)> =
        read.into_iter().filter(|(file, _)| !parts.iter().any(|part| part.file == *file)).collect();
    if let Some((file, _)) = rest.iter().find(|(_, value)| has_camera(value)) {
        return Err(parts[0].wrong(&format!(
            "is of a stereo pair, whose world is that of its first camera, but {} has a camera with a pose of its own: move one \
             of them away, or write one camera per file or per map, each with its own pose, world to camera",
            file.display()
        )));
    }
    let (complete, mut partial): (Vec<Part>, Vec<Part>) = parts.into_iter().partition(Part::is_complete);
    let joined = match (complete.is_empty(), partial.is_empty()) {
        (true, _) => {
            let mut first = partial.remove(0);
            partial.into_iter().try_for_each(|part| first.join(part))?;
            pair(files, first, notes)?
        }
        (false, true) => match <[Part; 1]>::try_from(complete) {
            Ok([only]) => pair(files, only, notes)?,
            Err(several) => opencv_chain::cameras(files, several, notes)?,
        },
        (false, false) => {
            return Err(partial[0].wrong(&format!(
                "is a part of a stereo pair, but {} has all of one: move one of them away",
                complete[0].file.display()
            )));
        }
    };
    Ok(std::iter::once(joined).chain(rest).collect())
}

/// The cameras of one pair.
fn pair(files: &dyn Files, mut part: Part, notes: &mut Notes) -> Result<(PathBuf, Value), Failure> {
    let Some([r, t]) = part.pose.clone() else {
        return Err(
            part.wrong("has lenses of a stereo pair, but its R and T are missing: add them, or the file that has them")
        );
    };
    part.drop_derived(notes)?;
    let [(first, first_keys), (second, second_keys)] = part.pair()?;
    let marks = [first, second];
    let mut cameras = [first_keys.clone(), second_keys.clone()];
    let have_pictures = cameras.iter().all(|camera| find(camera, NAME).or_else(|| find(camera, IMAGE)).is_some());
    if !have_pictures {
        let folder = part.file.parent().unwrap_or(Path::new(""));
        let sides = vec![Mark::Left, Mark::Right];
        let from_zero = vec![Mark::Number(0), Mark::Number(1)];
        let others = match marks {
            [Mark::Number(0), _] => vec![sides],
            [Mark::Number(_), _] => vec![sides, from_zero],
            _ => Vec::new(),
        };
        let names = picture_names(files, folder, &marks, &others).map_err(|problem| part.wrong(&problem))?;
        for (camera, name) in cameras.iter_mut().zip(names) {
            camera.entry("name").or_insert(name.into());
        }
    }
    let [first, second] = &mut cameras;
    first.extend(identity());
    second.extend([(String::from("R"), r), (String::from("t"), t)]);
    let name = |camera: &Object| find(camera, NAME).or_else(|| find(camera, IMAGE)).and_then(|(_, name)| text(name));
    let [first, second] = [&cameras[0], &cameras[1]].map(|camera| name(camera).unwrap_or_default());
    notes.add(format!(
        "{}: is a stereo pair: the world is that of its first camera, `{first}`, and R and T lead from it to `{second}`",
        part.file.display()
    ));
    notes.add(String::from("two cameras are too few for a mesh: a frame needs three or more"));
    Ok(part.with_cameras(cameras))
}
