//! What is known of a calibration after it has been checked.

use super::{finding::Finding, residuals::Residuals};
use crate::camera::Camera;
use alloc::vec::Vec;

/// What became of the refinement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The refined cameras agree better with what was held out.
    Improved,
    /// The refined cameras agree no better with what was held out, so that the given ones are kept.
    Kept,
    /// There is too little to judge by, so that the given cameras are kept.
    Undecided,
}

/// Standard deviations of a refined camera, in pixels at the object.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Uncertainty {
    /// Of its direction: the standard deviation of its rotation about x and y, times the focal length.
    pub direction_px: f64,
    /// Of its roll, at a quarter of the picture's width from the middle.
    pub roll_px: f64,
    /// Of its centre across the line of sight, divided by the footprint. Direction and centre are correlated: a turn and a
    /// shift look nearly alike.
    pub centre_px: f64,
    /// Of where it sees the object, which is what counts.
    pub object_px: f64,
}

/// One camera.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CameraReport {
    /// Residuals of the given calibration.
    pub given: Residuals,
    /// Residuals of the refined calibration, whether it is kept or not.
    pub refined: Residuals,
    /// How far the refinement moves the object in this camera's picture, as the root of the mean square, in pixels.
    pub moved_px: f64,
    /// How certain the refined camera is; `None` if it is not determined.
    pub uncertainty: Option<Uncertainty>,
    /// Intersection over union of the camera's silhouette and the hull of all cameras, with the given calibration, as the
    /// mean over the frames. `None` if the camera has no silhouette, or if there is no hull.
    pub silhouette_overlap: Option<f64>,
    /// Brightness of its pictures over the mean of all cameras. `None` if it could not be compared.
    pub gain: Option<f64>,
}

/// The result of [`super::calibrate`].
#[derive(Debug, Clone, PartialEq)]
pub struct Calibration {
    /// The refined cameras if they are better, else the given ones, in the order in which they were given.
    pub cameras: Vec<Camera>,
    /// What became of the refinement.
    pub verdict: Verdict,
    /// One report per camera, in the order in which they were given.
    pub reports: Vec<CameraReport>,
    /// Mean loss over what was held out, with the given and with the refined cameras; smaller is better. `None` if too
    /// little was held out.
    pub held_out: Option<[f64; 2]>,
    /// Mean over all pairs of neighbouring cameras of the median distance of matches from their epipolar lines, in pixels,
    /// with the given and with the refined cameras. `None` without matches.
    pub epipolar_bias_px: Option<[f64; 2]>,
    /// Number of points that were matched in two or more views.
    pub points: u32,
    /// What is wrong with the given calibration.
    pub findings: Vec<Finding>,
}
