//! Background subtraction (§0): silhouettes from a picture of the empty set.

use super::{colour::vector, matte};
use crate::image::ImageRef;
use alloc::{format, string::String, vec::Vec};

/// Shadows, and light reflected by the object, scale the background's brightness by a factor in this range. A larger
/// change indicates the object.
const SHADING: [f32; 2] = [0.5, 1.2];
/// Colours differ if their distance exceeds this many levels plus [`RELATIVE`] times the background's brightness.
const NOISE: f32 = 14.0;
const RELATIVE: f32 = 0.08;
/// Parts and holes that cover less than these fractions of the picture are removed, as for [`super::ChromaKey`].
const SMALLEST_PART: f32 = 3e-4;
const SMALLEST_HOLE: f32 = 5e-5;

/// Coverage of the object in a real (distorted) picture, given as packed RGB. `plate` is the same camera's picture
/// without the object.
pub(crate) fn coverage(picture: &ImageRef, rgb: &[u8], plate: &ImageRef) -> Result<Vec<u8>, String> {
    let (w, h) = (picture.width as usize, picture.height as usize);
    plate.check().map_err(|problem| format!("the clean plate: {problem}"))?;
    if (plate.width, plate.height) != (picture.width, picture.height) {
        return Err(format!(
            "the clean plate is {} x {} pixels but the picture is {w} x {h}: take it with the same camera",
            plate.width, plate.height
        ));
    }
    let plate = plate.to_rgb();
    let differs = |(pixel, empty): (&[u8], &[u8])| {
        let (colour, empty) = (vector(pixel), vector(empty));
        let brightness = empty.length_squared();
        let shade = (colour.dot(empty) / brightness.max(1.0)).clamp(SHADING[0], SHADING[1]);
        let limit = NOISE + RELATIVE * libm::sqrtf(brightness);
        (colour - empty * shade).length_squared() > limit * limit
    };
    let mut object: Vec<bool> = rgb.chunks_exact(3).zip(plate.chunks_exact(3)).map(differs).collect();
    let pixels = |share: f32| (share * (w * h) as f32) as usize;
    matte::remove_small(w, h, &mut object, true, pixels(SMALLEST_PART));
    matte::remove_small(w, h, &mut object, false, pixels(SMALLEST_HOLE));
    Ok(matte::soften(w, h, rgb, &object))
}
