//! Several stereo pairs of OpenCV that share cameras: files whose names have the numbers of their two cameras, such as
//! `stereo_1_2.yml` and `cam2-cam3.json`. The world is that of the camera with the smallest number.

use super::{
    marks::{Mark, picture_names},
    notes::Notes,
    opencv_keys::Object,
    opencv_part::Part,
    values::{numbers, to_array},
    view::rotation,
};
use crate::{failure::Failure, files::Files};
use glam::{DMat3, DVec3};
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

/// The largest difference of two values that count as the same, relative to the larger one: files have few digits.
const SAME: f64 = 1e-6;

/// The step from the camera `from` to the camera `to`: `x' = r x + t`.
struct Step {
    from: u32,
    to: u32,
    r: DMat3,
    t: DVec3,
}

/// The cameras of a chain of complete pairs.
pub fn cameras(files: &dyn Files, parts: Vec<Part>, notes: &mut Notes) -> Result<(PathBuf, Value), Failure> {
    let mut lenses: BTreeMap<u32, (Object, PathBuf)> = BTreeMap::new();
    let mut steps = Vec::new();
    let mut parts = parts;
    for part in &mut parts {
        part.drop_derived(notes)?;
        let stem = part.file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let Some([from, to]) = two_numbers(&stem) else {
            return Err(part.wrong("is one of several stereo pairs, and its name does not tell which cameras it has: name the files after their \
                 cameras, such as `stereo_1_2.yml`, or write one camera per file or per map, each with its own pose, world to \
                 camera",
            ));
        };
        let pair = part.pair()?;
        for (number, (_, own)) in [from, to].into_iter().zip(pair) {
            match lenses.get(&number) {
                Some((known, file)) if !is_same(&known.clone().into(), &own.clone().into()) => {
                    return Err(part.wrong(&format!(
                        "camera {number} has another lens than in {}: calibrate every lens once, and the pairs with \
                             CALIB_FIX_INTRINSIC",
                        file.display()
                    )));
                }
                Some(_) => {}
                None => {
                    lenses.insert(number, (own.clone(), part.file.clone()));
                }
            }
        }
        let step = |[r, t]: &[Value; 2]| -> Result<Step, String> {
            let r = numbers(r).and_then(|n| rotation(&n)).map_err(|problem| format!("R: {problem}"))?;
            let t: [f64; 3] = numbers(t).and_then(|n| to_array(&n, "T"))?;
            Ok(Step { from, to, r: DMat3::from_cols_array_2d(&r).transpose(), t: t.into() })
        };
        let step = part.pose.as_ref().map(step).transpose().map_err(|problem| part.wrong(&problem))?;
        steps.extend(step);
    }
    let numbers: Vec<u32> = lenses.keys().copied().collect();
    let first = parts.remove(0);
    let poses = poses(&numbers, &steps).map_err(|problem| first.wrong(&problem))?;
    let folder = first.file.parent().unwrap_or(Path::new(""));
    let marks: Vec<Mark> = numbers.iter().map(|&number| Mark::Number(number)).collect();
    let names = picture_names(files, folder, &marks, &[]).map_err(|problem| first.wrong(&problem))?;
    notes.add(format!(
        "{}: is one of {} stereo pairs that make a chain: the world is that of camera `{}`, and R and T lead from the first \
         camera in the name of a file to the second",
        first.file.display(),
        steps.len(),
        names[0]
    ));
    let cameras: Vec<Object> = lenses
        .into_values()
        .zip(names)
        .zip(poses)
        .map(|(((mut keys, _), name), (r, t))| {
            keys.insert(String::from("name"), name.into());
            keys.insert(String::from("R"), json!(r.transpose().to_cols_array()));
            keys.insert(String::from("t"), json!(t.to_array()));
            keys
        })
        .collect();
    Ok(first.with_cameras(cameras))
}

/// The two different numbers of a name, in their order. A name with more or fewer has none.
fn two_numbers(name: &str) -> Option<[u32; 2]> {
    let digits = name.split(|c: char| !c.is_ascii_digit()).filter(|part| !part.is_empty());
    let numbers: Vec<u32> = digits.map(str::parse).collect::<Result<_, _>>().ok()?;
    <[u32; 2]>::try_from(numbers).ok().filter(|[a, b]| a != b)
}

/// Whether two calibrations of a lens are the same up to the digits of a file.
fn is_same(a: &Value, b: &Value) -> bool {
    let close = |a: f64, b: f64| (a - b).abs() <= SAME * a.abs().max(b.abs());
    match (a, b) {
        (Value::Object(first), Value::Object(second)) if !first.contains_key("data") => {
            first.len() == second.len()
                && first.iter().all(|(key, value)| second.get(key).is_some_and(|other| is_same(value, other)))
        }
        _ => match (numbers(a), numbers(b)) {
            (Ok(a), Ok(b)) => a.len() == b.len() && a.into_iter().zip(b).all(|(a, b)| close(a, b)),
            _ => a == b,
        },
    }
}

/// The pose of every camera, world to camera, where the first camera is the world. Every step is used once.
fn poses(cameras: &[u32], steps: &[Step]) -> Result<Vec<(DMat3, DVec3)>, String> {
    let mut found = BTreeMap::from([(cameras[0], (DMat3::IDENTITY, DVec3::ZERO))]);
    let mut open: Vec<&Step> = steps.iter().collect();
    loop {
        let next = open.iter().position(|step| found.contains_key(&step.from) || found.contains_key(&step.to));
        let Some(next) = next else { break };
        let Step { from, to, r, t } = open.remove(next);
        match (found.get(from).copied(), found.get(to).copied()) {
            (Some((of_r, of_t)), None) => found.insert(*to, (*r * of_r, *r * of_t + *t)),
            (None, Some((of_r, of_t))) => found.insert(*from, (r.transpose() * of_r, r.transpose() * (of_t - *t))),
            _ => {
                return Err(format!(
                    "is one of several stereo pairs that lead to the same camera in two ways, one by the pair of cameras {from} \
                     and {to}: move that pair away"
                ));
            }
        };
    }
    let pose = |camera: &u32| {
        found.get(camera).copied().ok_or_else(|| {
            format!(
                "is one of several stereo pairs, but no pair leads from camera {} to camera {camera}: add it, or write one \
                 camera per file or per map, each with its own pose, world to camera",
                cameras[0]
            )
        })
    };
    cameras.iter().map(pose).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_pairs_have_two_numbers() {
        for (name, expected) in [
            ("stereo_1_2", Some([1, 2])),
            ("cam03-cam02", Some([3, 2])),
            ("calibration_cam12", None),
            ("2024_1_2", None),
            ("1_1", None),
            ("pair", None),
        ] {
            assert_eq!(two_numbers(name), expected, "{name}");
        }
    }
}
