//! Recognises intrinsics that all cameras have wrong in the same way.
//!
//! Principal points lie near the middles of pictures, and those of several cameras lie around it. If all of them lie elsewhere
//! in the same way, K may belong to pictures of another size. Pictures that are cut out of larger ones look the same, so
//! that the silhouettes must decide.

use crate::camera::Camera;
use alloc::{format, string::String, vec::Vec};

/// Principal points in the middle are at this share of the picture's size, up to this deviation.
const MIDDLE: f64 = 0.5;
const DEVIATION: f64 = 0.04;
/// Without a principal point, K has zeros.
const MISSING: f64 = 0.02;

/// Cameras whose K is read in another way, with what to do about it. `None` if the principal points lie near the middles, or
/// not all of them elsewhere.
pub(crate) fn other_reading(cameras: &[Camera]) -> Option<(String, Vec<Camera>)> {
    let shares =
        |camera: &Camera| [camera.k[0][2] / f64::from(camera.width - 1), camera.k[1][2] / f64::from(camera.height - 1)];
    let all: Vec<f64> = cameras.iter().flat_map(shares).collect();
    let mean = all.iter().sum::<f64>() / all.len() as f64;
    let are_alike = all.iter().all(|share| (share - mean).abs() < DEVIATION * (mean / MIDDLE).max(1.0));
    let read = |k: &dyn Fn(&Camera) -> [[f64; 3]; 3]| -> Vec<Camera> {
        cameras.iter().map(|camera| Camera { k: k(camera), ..*camera }).collect()
    };
    if are_alike && mean.abs() < MISSING {
        let remedy = "K has no principal point: give cx and cy, near the middles of the pictures";
        let middle = |pixels: u32| MIDDLE * f64::from(pixels - 1);
        return Some((
            remedy.into(),
            read(&|camera| with_centre(camera, [middle(camera.width), middle(camera.height)])),
        ));
    }
    if are_alike && mean > DEVIATION && (mean - MIDDLE).abs() > DEVIATION {
        let scale = MIDDLE / mean;
        let remedy = format!(
            "K looks like that of pictures {:.2} times as large: multiply fx, fy, cx and cy by the ratio of the sizes, about \
             {scale:.2}",
            1.0 / scale
        );
        return Some((
            remedy,
            read(&|&Camera { k: [x, y, last], .. }| [x.map(|v| v * scale), y.map(|v| v * scale), last]),
        ));
    }
    let is_central = |camera: &Camera| shares(camera).iter().all(|share| (share - MIDDLE).abs() < DEVIATION);
    let exchanged = read(&|camera| with_centre(camera, [camera.k[1][2], camera.k[0][2]]));
    let are_exchanged = !cameras.iter().any(is_central) && exchanged.iter().all(is_central);
    are_exchanged.then(|| ("cx and cy look exchanged: exchange them in K".into(), exchanged))
}

/// K with another principal point.
fn with_centre(camera: &Camera, [x, y]: [f64; 2]) -> [[f64; 3]; 3] {
    let mut k = camera.k;
    (k[0][2], k[1][2]) = (x, y);
    k
}
