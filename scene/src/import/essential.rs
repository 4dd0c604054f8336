//! The essential matrix that a file of a stereo pair has beside R and T (Hartley and Zisserman, Multiple View Geometry in
//! Computer Vision, §9.6): E = [T]× R, up to its scale and sign.

use glam::{DMat3, DVec3};

/// Most by which an entry of E may differ, of matrices whose sum of squares is 1. Files have six digits or more.
const TOLERANCE: f64 = 1e-3;

/// Refuses an E that does not follow from R and T.
pub fn check(e: &[f64; 9], r: [[f64; 3]; 3], t: DVec3) -> Result<(), String> {
    let Some(e) = scaled(DMat3::from_cols_array(e).transpose()) else { return Ok(()) };
    let r = DMat3::from_cols_array_2d(&r).transpose();
    let back = r.transpose();
    if follows(e, r, t) {
        Ok(())
    } else if follows(e, back, -(back * t)) {
        Err(String::from(
            "the essential matrix says that R and T lead from the second camera to the first, but they must lead from the first \
             to the second: exchange the lenses, or invert R and T",
        ))
    } else {
        Err(String::from(
            "the essential matrix does not follow from R and T: if it is of another calibration, remove it, otherwise write the \
             R and T of `stereoCalibrate`, from the first camera to the second",
        ))
    }
}

/// Whether a matrix is that of a pose. Without a distance between the cameras there is none.
fn follows(e: DMat3, r: DMat3, t: DVec3) -> bool {
    let cross = DMat3::from_cols(DVec3::new(0.0, t.z, -t.y), DVec3::new(-t.z, 0.0, t.x), DVec3::new(t.y, -t.x, 0.0));
    let is_near = |other: DMat3| e.abs_diff_eq(other, TOLERANCE);
    scaled(cross * r).is_none_or(|expected| is_near(expected) || is_near(-expected))
}

/// The matrix with 1 as the sum of its squares; `None` if it is zero or not finite.
fn scaled(m: DMat3) -> Option<DMat3> {
    let norm = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length()).length();
    (norm > 0.0 && norm.is_finite()).then(|| m * (1.0 / norm))
}
