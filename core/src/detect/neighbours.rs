//! Which views a view is compared with: N(P) of eq. 1, chosen by angle.

use crate::camera::Pinhole;
use alloc::vec::Vec;

/// Cosine of 6°: views nearer than that see too little parallax.
const NEAREST_COSINE: f32 = 0.9945;
/// Cosine of 65°: views further apart hardly share a surface.
const FARTHEST_COSINE: f32 = 0.4226;

/// The views that a view can be compared with: the smallest angle to it first, ties by index; as seen from the origin,
/// on which the cameras look.
pub fn neighbours(cameras: &[Pinhole], view: usize) -> Vec<u16> {
    let toward = |c: &Pinhole| c.centre.normalize_or_zero();
    let own = toward(&cameras[view]);
    let mut others: Vec<(f32, u16)> = cameras
        .iter()
        .enumerate()
        .filter(|&(i, _)| i != view)
        .map(|(i, c)| (toward(c).dot(own), i as u16))
        .filter(|&(cosine, _)| cosine < NEAREST_COSINE && cosine > FARTHEST_COSINE)
        .collect();
    others.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    others.into_iter().map(|(_, i)| i).collect()
}
