//! Colours as vectors.

use glam::Vec3;

/// Converts three packed bytes to a colour vector.
pub(super) fn vector(rgb: &[u8]) -> Vec3 {
    Vec3::new(f32::from(rgb[0]), f32::from(rgb[1]), f32::from(rgb[2]))
}
