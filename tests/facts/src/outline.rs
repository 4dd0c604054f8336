//! The true silhouettes, from the scene's own function and not from rendered masks.

use crate::Shot;
use glam::DVec3;
use pcmvs_core::Camera;
use studio::Solid;

/// Pixels inside an outline beyond which only "inside" is said.
const DEEP: f64 = 2.0;

/// How far inside the true outline a camera sees a world point, in pixels, negative outside; exact near 0, at most
/// `DEEP`. None where the point is not in the picture.
pub fn margin(solid: &Solid, camera: &Camera, point: DVec3) -> Option<f64> {
    let (pixel, depth) = camera.project(point)?;
    let (right, bottom) = (f64::from(camera.width) - 1.0, f64::from(camera.height) - 1.0);
    if pixel.x < 0.0 || pixel.y < 0.0 || pixel.x > right || pixel.y > bottom {
        return None;
    }
    let focal = libm::sqrt(camera.k[0][0] * camera.k[1][1]);
    let eye = camera.centre();
    let (to, (centre, radius)) = (point - eye, scene.ball());
    let direction = to.normalize();
    let cosine = depth / to.length();
    let middle = (centre - eye).dot(direction);
    let (mut t, mut most) = (middle - radius, f64::MIN);
    // Beyond the scene's ball a ray only goes away from the scene.
    while t < middle + radius {
        let d = scene.distance(eye + direction * t);
        let pixels = -d * focal / (t * cosine);
        most = most.max(pixels);
        if pixels > DEEP {
            return Some(DEEP);
        }
        t += (0.9 * d.abs()).max(0.05 * t * cosine / focal);
    }
    Some(most)
}

/// Least margin over the cameras that see a point and have a mask: positive inside the true outlines' hull. What fewer
/// than two of them see is outside.
pub fn hull_margin(shot: &Shot, point: DVec3) -> f64 {
    let (least, count) = seen_margin(shot, point);
    if count < 2 { f64::NEG_INFINITY } else { least }
}

/// Least margin over the cameras that see a point and have a mask, and how many do.
pub fn seen_margin(shot: &Shot, point: DVec3) -> (f64, usize) {
    let masked = shot.cameras.iter().zip(&shot.frame.masks).filter(|(_, mask)| mask.is_some());
    let margins = masked.filter_map(|(camera, _)| margin(shot.truth(), camera, point));
    margins.fold((f64::INFINITY, 0), |(least, count), m| (least.min(m), count + 1))
}
