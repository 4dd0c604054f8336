//! The form in which signed distances are stored. 16 bits hold those in the largest pictures, with full precision near the
//! contour.
//!
//! Up to 256 pixels a stored distance is in 1/64 pixel. Beyond that each step is 4 pixels, and distances are rounded towards
//! the contour. They are therefore never larger than the true ones, so that a search may rely on them, and their order is
//! preserved.

use crate::{
    math::{max, min},
    simd::truncate,
};

/// Stored steps per pixel near the contour.
pub const UNITS: f32 = 64.0;
/// The largest distance that is stored in [`UNITS`].
const NEAR: i32 = 256 * 64;
/// Number of [`UNITS`] in a step beyond [`NEAR`]: 4 pixels.
const STEP: i32 = 4 * 64;
/// The largest distance that can be stored, in [`UNITS`]: 65784 pixels. The diagonal of the largest picture is 46341 pixels
/// long. The next larger number marks pixels without a distance.
const LARGEST: i32 = NEAR + (i16::MAX as i32 - 1 - NEAR) * STEP;

/// Stored form of a signed distance in [`UNITS`], rounded towards the contour.
#[inline(always)]
pub fn stored(distance: f32) -> i16 {
    let distance = max(min(distance, LARGEST as f32), -LARGEST as f32);
    let near = max(min(distance, NEAR as f32), -NEAR as f32);
    truncate(near + (distance - near) * (1.0 / STEP as f32)) as i16
}

/// Stored form of a signed distance in whole [`UNITS`], at most those of [`LARGEST`].
#[inline(always)]
pub fn stored_whole(distance: i32) -> i16 {
    let near = distance.clamp(-NEAR, NEAR);
    (near + (distance - near) / STEP) as i16
}

/// The signed distance in [`UNITS`] from its stored form.
#[inline(always)]
pub fn units(stored: i16) -> i32 {
    let stored = i32::from(stored);
    let near = stored.clamp(-NEAR, NEAR);
    near + (stored - near) * STEP
}

/// The signed distance in pixels from its stored form, which may be interpolated. Interpolation across the end of the exact
/// range is not larger than that of the distances either.
#[inline(always)]
pub fn pixels(stored: f32) -> f32 {
    let near = max(min(stored, NEAR as f32), -NEAR as f32);
    (near + (stored - near) * STEP as f32) * (1.0 / UNITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_in_the_largest_pictures_are_stored_with_full_precision_near_the_contour() {
        let mut last = 0;
        for distance in (0..2 * NEAR).chain((2 * NEAR..=LARGEST).step_by(77)).chain([LARGEST]) {
            assert_eq!(
                [stored_whole(distance), stored_whole(-distance)],
                [distance, -distance].map(|d| stored(d as f32))
            );
            let (there, back) = (stored(distance as f32), units(stored(distance as f32)));
            assert_eq!(stored(-distance as f32), -there);
            assert_eq!(units(-there), -back);
            assert_eq!(pixels(f32::from(-there)), -back as f32 / UNITS);
            assert!((last..i16::MAX).contains(&there), "the order is preserved");
            last = there;
            let lost = distance - back;
            assert!(
                if distance <= NEAR { lost == 0 } else { (0..4 * 64).contains(&lost) },
                "{distance} becomes {back}"
            );
        }
        assert!(LARGEST as f32 / UNITS > 46341.0);
    }
}
