//! Rotations without the platform's transcendental functions.

use glam::DMat3;

/// Rotation about x, then y, then z (radians).
pub fn turn(x: f64, y: f64, z: f64) -> DMat3 {
    let ((sx, cx), (sy, cy), (sz, cz)) = (libm::sincos(x), libm::sincos(y), libm::sincos(z));
    let about_x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
    let about_y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
    let about_z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
    about_z * about_y * about_x
}
