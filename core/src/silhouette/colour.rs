//! Colours as vectors.

use glam::Vec3;

/// Converts three packed bytes to a colour vector.
pub(super) fn vector(rgb: &[u8]) -> Vec3 {
    Vec3::new(f32::from(rgb[0]), f32::from(rgb[1]), f32::from(rgb[2]))
}

/// Angle between a colour and grey in radians.
pub(super) fn from_gray(colour: Vec3) -> f32 {
    angle(colour, Vec3::ONE)
}

/// Angle between two colour vectors in radians.
pub(super) fn angle(a: Vec3, b: Vec3) -> f32 {
    let lengths = libm::sqrtf(a.length_squared() * b.length_squared());
    if lengths > 0.0 { libm::acosf((a.dot(b) / lengths).clamp(-1.0, 1.0)) } else { 0.0 }
}

/// Whether the angle between two colour vectors is at most the one with the given cosine.
pub(super) fn within(colour: Vec3, centre: Vec3, cosine: f32) -> bool {
    let along = colour.dot(centre);
    along > 0.0 && along * along >= cosine * cosine * colour.length_squared() * centre.length_squared()
}
