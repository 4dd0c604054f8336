//! Pictures from which the object has been cut out: what surrounds it was replaced by one colour, along the given matte.
//!
//! Such a picture says nothing about the world outside its matte. Where the matte lacks a part of the object, the picture
//! lacks it as well.

use crate::silhouette::Silhouette;

/// Pixels farther outside the contour than this count, in pixels: compression blurs the object's colours across the
/// contour.
const OUTSIDE: f32 = -12.0;
/// Smallest share of these pixels that have the colour, and how far each channel of such a pixel may be from it.
const SHARE: f32 = 0.9999;
const TOLERANCE: u8 = 2;
/// One in so many pixels votes for the colour.
const VOTING: usize = 16;
/// What is looked at first: one in so many pixels, and whether one in so many has another colour than the pixel beside it. That
/// is more than may differ from any single colour, so that most photographs need no further look.
const FIRST: usize = 32;
const DIFFERING: usize = 9000;

/// Whether a picture shows one single colour outside its silhouette. Photographs of real backdrops have noise.
pub(crate) fn is_cut_out(rgb: &[u8], silhouette: &Silhouette) -> bool {
    let outside = (OUTSIDE * Silhouette::UNITS) as i16;
    let pixels = || rgb.chunks_exact(3).zip(silhouette.distances()).filter(|&(_, &d)| d < outside).map(|(p, _)| p);
    let differ = |a: &[u8], b: &[u8]| a.iter().zip(b).any(|(&a, &b)| a.abs_diff(b) > 2 * TOLERANCE);
    let (mut first, mut pairs) = (pixels().take(silhouette.distances().len() / FIRST), 0);
    while let (Some(a), Some(b)) = (first.next(), first.next()) {
        pairs += usize::from(differ(a, b));
    }
    if pairs > silhouette.distances().len() / DIFFERING + 16 {
        return false;
    }
    // The colour that more than half of the pixels have, if there is one (Boyer and Moore's majority vote). Some of them vote.
    let (mut colour, mut votes) = ([0u8; 3], 0u32);
    for pixel in pixels().step_by(VOTING) {
        if votes == 0 {
            colour.copy_from_slice(pixel);
        }
        if *pixel == colour { votes += 1 } else { votes -= 1 }
    }
    let (mut near, mut total) = (0u32, 0u32);
    for (pixel, &d) in rgb.as_chunks::<3>().0.iter().zip(silhouette.distances()) {
        let [r, g, b] = [0, 1, 2].map(|k| pixel[k].abs_diff(colour[k]) <= TOLERANCE);
        near += u32::from((d < outside) & r & g & b);
        total += u32::from(d < outside);
    }
    votes > 0 && near >= ((SHARE * total as f32) as u32).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{pinhole, silhouette_of};
    use alloc::vec::Vec;
    use glam::Vec3;

    /// Its backdrop alone decides: constant or nearly so, or with the noise of a sensor.
    #[test]
    fn pictures_without_noise_outside_the_object_are_cut_out() {
        let camera = pinhole(Vec3::new(4.0, 0.0, 0.0), Vec3::ZERO, 120, 200.0);
        let view = silhouette_of(&[(Vec3::ZERO, 0.6)], &camera, 0);
        let silhouette = view.silhouette.as_deref().expect("it has one");
        let mut random = 1u32;
        let mut picture = |levels: &[u8]| -> Vec<u8> {
            let mut level = || {
                random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                levels[(random >> 16) as usize % levels.len()]
            };
            let pixel = |&d: &i16| [if d > 0 { 90 } else { level() }; 3];
            silhouette.distances().iter().flat_map(pixel).collect()
        };
        assert!(is_cut_out(&picture(&[250]), silhouette));
        assert!(is_cut_out(&picture(&[250, 250, 250, 249]), silhouette), "compression changes single levels");
        assert!(!is_cut_out(&picture(&[250, 249, 248, 247, 246, 245]), silhouette));
        // An object that the matte lacks.
        let mut lacking = picture(&[250]);
        lacking[..3 * 120 * 4].fill(40);
        assert!(!is_cut_out(&lacking, silhouette));
    }
}
