//! Which views a view is compared with: N(P) of eq. 1, chosen by angle.

use crate::camera::Pinhole;
use alloc::vec::Vec;
use glam::Vec3;

/// Cosine of 6°: views nearer than that see too little parallax.
const NEAREST_COSINE: f32 = 0.9945;
/// Cosine of 65°: views further apart hardly share a surface.
const FARTHEST_COSINE: f32 = 0.4226;

/// The `count` views with the smallest angle to a view, seen from the object at `target`; nearest first, ties by index.
pub fn neighbours(cameras: &[Pinhole], view: usize, target: Vec3, count: usize) -> Vec<u16> {
    let toward = |c: &Pinhole| (c.centre - target).normalize_or_zero();
    let own = toward(&cameras[view]);
    let mut others: Vec<(f32, u16)> = cameras
        .iter()
        .enumerate()
        .filter(|&(i, _)| i != view)
        .map(|(i, c)| (toward(c).dot(own), i as u16))
        .filter(|&(cosine, _)| cosine < NEAREST_COSINE && cosine > FARTHEST_COSINE)
        .collect();
    others.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    others.truncate(count);
    others.into_iter().map(|(_, i)| i).collect()
}
