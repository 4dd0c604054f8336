//! The views that a view is compared with: N(P) of eq. 1 (§4.1), selected by angle.

use crate::{camera::Pinhole, math::ordered, sort::short};
use alloc::vec::Vec;

/// Cosine of 6°: views closer than this have too little parallax.
const MAX_COSINE: f32 = 0.9945;
/// Cosine of 65°: views farther apart hardly see the same surface.
const MIN_COSINE: f32 = 0.4226;

/// The views that a view can be compared with, sorted by increasing angle to it; ties are broken by index. Angles are
/// measured at the origin, which all cameras face.
pub fn neighbours(cameras: &[Pinhole], view: usize) -> Vec<u16> {
    let toward = |c: &Pinhole| c.centre.normalize_or_zero();
    let own = toward(&cameras[view]);
    let mut others: Vec<u64> = cameras
        .iter()
        .enumerate()
        .filter(|&(i, _)| i != view)
        .map(|(i, c)| (toward(c).dot(own), i as u64))
        .filter(|&(cosine, _)| cosine < MAX_COSINE && cosine > MIN_COSINE)
        .map(|(cosine, i)| u64::from(ordered(-cosine)) << 16 | i)
        .collect();
    short(&mut others);
    others.into_iter().map(|key| key as u16).collect()
}
