//! Where the cameras look, and how many of them it takes.

use crate::camera::Camera;
use glam::{DMat3, DVec3};

/// Smallest number of views, and of silhouettes, for a reconstruction.
pub const MIN_VIEWS: u32 = 3;

/// The point nearest to all optical axes in the least-squares sense. It is pulled slightly towards the mean of the
/// camera centres, so that it also exists for parallel axes.
pub(crate) fn meeting_point<'a>(cameras: impl ExactSizeIterator<Item = &'a Camera> + Clone) -> DVec3 {
    let mean = cameras.clone().map(Camera::centre).sum::<DVec3>() / cameras.len() as f64;
    let (mut a, mut b) = (DMat3::IDENTITY * 1e-9, mean * 1e-9);
    for camera in cameras {
        let d = camera.direction();
        let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
        a += across;
        b += across * camera.centre();
    }
    a.inverse() * b
}
