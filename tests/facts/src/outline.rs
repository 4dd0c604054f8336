//! The true silhouettes, from the signed distance function of a solid instead of rendered masks.

use crate::Shot;
use glam::DVec3;
use pcmvs_core::Camera;
use studio::Solid;

/// Largest distance from an outline that is measured, in pixels. Points deeper inside count as this deep.
const MAX_MARGIN: f64 = 2.0;

/// Distance of a world point from the true outline in a camera's picture, in pixels: positive inside, exact near 0, at most
/// `MAX_MARGIN`. None if the point is not in the picture.
pub fn margin(solid: &Solid, camera: &Camera, point: DVec3) -> Option<f64> {
    let (pixel, depth) = camera.project(point)?;
    let (right, bottom) = (f64::from(camera.width) - 1.0, f64::from(camera.height) - 1.0);
    if pixel.x < 0.0 || pixel.y < 0.0 || pixel.x > right || pixel.y > bottom {
        return None;
    }
    let focal = libm::sqrt(camera.k[0][0] * camera.k[1][1]);
    let eye = camera.centre();
    let (to, (centre, radius)) = (point - eye, solid.ball());
    let direction = to.normalize();
    let cosine = depth / to.length();
    let middle = (centre - eye).dot(direction);
    let (mut t, mut most) = (middle - radius, f64::MIN);
    // Behind the bounding ball the ray only moves away from the solid.
    while t < middle + radius {
        let d = solid.distance(eye + direction * t);
        let pixels = -d * focal / (t * cosine);
        most = most.max(pixels);
        if pixels > MAX_MARGIN {
            return Some(MAX_MARGIN);
        }
        t += (0.9 * d.abs()).max(0.05 * t * cosine / focal);
    }
    Some(most)
}

/// Smallest margin over the cameras that see a point and have a mask: positive inside the hull of the true outlines. A
/// point that fewer than two of them see is outside.
pub fn hull_margin(shot: &Shot, point: DVec3) -> f64 {
    let (least, count) = seen_margin(shot, point);
    if count < 2 { f64::NEG_INFINITY } else { least }
}

/// Smallest margin over the cameras that see a point and have a mask, and the number of these cameras.
pub fn seen_margin(shot: &Shot, point: DVec3) -> (f64, usize) {
    let masked = shot.cameras.iter().zip(&shot.frame.masks).filter(|(_, mask)| mask.is_some());
    let margins = masked.filter_map(|(camera, _)| margin(shot.truth(), camera, point));
    margins.fold((f64::INFINITY, 0), |(least, count), m| (least.min(m), count + 1))
}
