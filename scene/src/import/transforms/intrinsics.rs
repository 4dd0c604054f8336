//! Size, projection and lens of a frame, in the spellings of several programs.

use crate::import::{
    lens,
    values::{self, Levels, find, number, numbers},
};
use crate::lens::LensModel;
use pcmvs_core::Lens;
use serde_json::{Map, Value};

const WIDTH: &[&str] = &["w", "width"];
const HEIGHT: &[&str] = &["h", "height"];
/// OpenCV's matrix, whose first pixel's centre is at (0, 0).
const K: &[&str] = &[
    "K",
    "intrinsic",
    "intrinsics",
    "intrinsic_matrix",
    "intrinsics_matrix",
    "camera_matrix",
    "camera_intrinsics",
    "camera_intrinsic",
    "intrinsic_params",
];
/// Focal lengths in pixels, and angles of view in degrees and radians. x, then y.
const FOCAL: [&[&str]; 2] = [&["fl_x", "fx", "focal_x"], &["fl_y", "fy", "focal_y"]];
const DEGREES: [&[&str]; 2] = [&["x_fov"], &["y_fov"]];
const RADIANS: [&[&str]; 2] = [&["camera_angle_x"], &["camera_angle_y"]];
/// Pixels from the picture's corner. x, then y.
const CENTRE: [&[&str]; 2] = [&["cx"], &["cy"]];
/// OpenCV's list of coefficients.
const LIST: &[&str] = &["distortion", "distortion_coefficients", "dist_coeffs", "distCoeffs", "D"];
/// nerfstudio's list: k1 k2 k3 k4 p1 p2.
const NERFSTUDIO: &[&str] = &["distortion_params"];
/// All keys that are read here.
pub const ALL: [&[&str]; 13] = [
    WIDTH, HEIGHT, K, FOCAL[0], FOCAL[1], DEGREES[0], DEGREES[1], RADIANS[0], RADIANS[1], CENTRE[0], CENTRE[1], LIST,
    NERFSTUDIO,
];
/// What a matrix K is taken for.
const ASSUMED: &str = "a matrix K is taken as OpenCV's, which puts the centre of the first pixel at (0, 0)";

type Matrix = [[f64; 3]; 3];

/// Width and height in pixels, if the file has them.
pub fn size(levels: &Levels) -> Result<Option<[u32; 2]>, String> {
    match (levels.number(WIDTH)?, levels.number(HEIGHT)?) {
        (Some(w), Some(h)) => values::size(w, h).map(Some),
        (None, None) => Ok(None),
        _ => Err(String::from("w and h are needed together: add the other, or remove both")),
    }
}

/// K of a scene, and what was assumed.
pub fn matrix(levels: &Levels, size: [u32; 2]) -> Result<(Matrix, Option<&'static str>), String> {
    let size = size.map(f64::from);
    for object in &levels.0 {
        let given = find(object, K).map(|(key, value)| from_matrix(&key, value).map(|k| (key, k))).transpose()?;
        if let Some((key, k)) = given {
            check_normalised(&key, &k, size)?;
            check_agreement(&key, &k, object)?;
            return Ok((k, Some(ASSUMED)));
        }
        // Parts of the projection for this frame replace a matrix for all frames.
        if focal(object, 0, size[0])?.is_some() {
            break;
        }
    }
    let of = |axis: usize| -> Result<Option<f64>, String> {
        for object in &levels.0 {
            if let Some(focal) = focal(object, axis, size[axis])? {
                return Ok(Some(focal));
            }
        }
        Ok(None)
    };
    let fx = of(0)?.ok_or_else(|| {
        String::from("the focal length is missing: add fl_x, camera_angle_x (radians), x_fov (degrees) or a matrix K")
    })?;
    let fy = of(1)?.unwrap_or(fx);
    let centre = |axis: usize| -> Result<f64, String> { Ok(levels.number(CENTRE[axis])?.unwrap_or(0.5 * size[axis])) };
    Ok(([[fx, 0.0, centre(0)? - 0.5], [0.0, fy, centre(1)? - 0.5], [0.0, 0.0, 1.0]], None))
}

/// Focal length in pixels along an axis.
fn focal(object: &Map<String, Value>, axis: usize, size: f64) -> Result<Option<f64>, String> {
    if let Some((key, value)) = find(object, FOCAL[axis]) {
        return number(&key, value).map(Some);
    }
    let of_angle = |angle: f64| 0.5 * size / libm::tan(0.5 * angle);
    if let Some((key, value)) = find(object, DEGREES[axis]) {
        return number(&key, value).map(|degrees| Some(of_angle(degrees.to_radians())));
    }
    let angle = find(object, RADIANS[axis]).map(|(key, value)| number(&key, value)).transpose()?;
    Ok(angle.map(of_angle))
}

/// A matrix with 3 or 4 rows and columns, nine numbers by rows, fx fy cx cy, or these four by name.
fn from_matrix(key: &str, value: &Value) -> Result<Matrix, String> {
    let wrong = || format!("{key} must be a matrix of 3 rows of 3 numbers, or fx fy cx cy: export it again");
    if let Some(object) = value.as_object()
        && !object.contains_key("data")
    {
        let parts = [FOCAL[0], FOCAL[1], CENTRE[0], CENTRE[1]];
        if let Some((other, _)) =
            object.iter().find(|(name, _)| parts.iter().all(|keys| !keys.contains(&name.as_str())))
        {
            return Err(format!("{key} has `{other}`, which is not understood there: put it beside {key}"));
        }
        let of = |keys: &[&str]| find(object, keys).ok_or_else(wrong).and_then(|(key, value)| number(&key, value));
        let (fx, fy) = (of(FOCAL[0])?, of(FOCAL[1])?);
        return Ok([[fx, 0.0, of(CENTRE[0])?], [0.0, fy, of(CENTRE[1])?], [0.0, 0.0, 1.0]]);
    }
    let columns = value.as_array().and_then(|rows| rows.first()?.as_array()).map(Vec::len);
    let n = numbers(value).map_err(|problem| format!("{key}: {problem}"))?;
    let at = |stride: usize| [0, 1, 2].map(|row| [0, 1, 2].map(|column| n[stride * row + column]));
    match (n.len(), columns) {
        (4, None) => Ok([[n[0], 0.0, n[2]], [0.0, n[1], n[3]], [0.0, 0.0, 1.0]]),
        (9, None | Some(3)) => Ok(at(3)),
        (12 | 16, Some(4)) => {
            let mut rest = vec![n[3], n[7], n[11]];
            rest.extend(n[12..].iter().take(3));
            let corner = n.get(15).copied().unwrap_or(1.0);
            if rest.iter().any(|&v| v != 0.0) || corner != 1.0 { Err(wrong()) } else { Ok(at(4)) }
        }
        _ => Err(wrong()),
    }
}

/// Refuses a matrix in units of the picture's size instead of pixels.
fn check_normalised(key: &str, k: &Matrix, size: [f64; 2]) -> Result<(), String> {
    let small = |axis: usize| k[axis][2] > 0.0 && k[axis][2] <= 1.0 && size[axis] > 8.0;
    if small(0) && small(1) {
        return Err(format!(
            "{key} has its principal point at ({}, {}), which looks like a share of the picture's size: give it in pixels",
            k[0][2], k[1][2]
        ));
    }
    Ok(())
}

/// Refuses a matrix that differs from the focal lengths or the principal point beside it.
fn check_agreement(key: &str, k: &Matrix, object: &Map<String, Value>) -> Result<(), String> {
    for axis in 0..2 {
        if let Some((name, value)) = find(object, FOCAL[axis]) {
            let given = number(&name, value)?;
            if (given - k[axis][axis]).abs() > 1e-3 * k[axis][axis].abs() {
                return Err(format!(
                    "{key} and {name} contradict each other ({} and {given}): remove the one that is wrong",
                    k[axis][axis]
                ));
            }
        }
        // The two differ by half a pixel where each is in its own convention.
        if let Some((name, value)) = find(object, CENTRE[axis]) {
            let given = number(&name, value)?;
            if (given - k[axis][2]).abs() > 0.75 {
                return Err(format!(
                    "{key} and {name} contradict each other ({} and {given}): remove the one that is wrong",
                    k[axis][2]
                ));
            }
        }
    }
    Ok(())
}

/// Distortion of a scene.
pub fn distortion(levels: &Levels) -> Result<Lens, String> {
    let model = lens::of_levels(levels)?;
    let named = lens::from_names(levels, model)?;
    let listed = if let Some((key, value)) = levels.find(LIST) {
        let list = numbers(value).map_err(|problem| format!("{key}: {problem}"))?;
        Some(lens::from_list(&key, &list, model)?)
    } else if let Some((key, value)) = levels.find(NERFSTUDIO) {
        let [k1, k2, k3, k4, p1, p2] = numbers(value).and_then(|n| values::to_array(&n, &key))?;
        let unused = |problem: &str| format!("{key} has {problem}, which is not supported: {}", lens::REMEDY);
        Some(match model {
            Some(LensModel::Fisheye) if [p1, p2] != [0.0; 2] => {
                return Err(unused("p1 or p2 of a fisheye"));
            }
            Some(LensModel::Fisheye) => Lens::Fisheye([k1, k2, k3, k4]),
            // It would be that of the eighth power of the radius, which OpenCV's model does not have.
            _ if k4 != 0.0 => return Err(unused(&format!("k4 = {k4}"))),
            _ => Lens::brown([k1, k2, p1, p2, k3]),
        })
    } else {
        None
    };
    match (named, listed) {
        (Some(named), Some(listed)) if named != listed => Err(String::from(
            "the list of coefficients and those by name contradict each other: remove those that are wrong",
        )),
        (named, listed) => Ok(listed.or(named).unwrap_or(lens::plainest(model))),
    }
}
