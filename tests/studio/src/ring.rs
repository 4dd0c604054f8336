//! Positions of the cameras.

use crate::{noise::Random, rotation::turn};
use core::f64::consts::TAU;
use glam::{DMat3, DVec3};
use pcmvs_core::{Camera, Lens};

/// Cameras spaced evenly on a horizontal circle that look at one point. The default is the dome of the paper: 20 cameras
/// of 1024 x 768 pixels, 3.8 m from the subject, looking down by 20 degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    /// Number of cameras.
    pub count: u32,
    /// Radius of the circle in metres.
    pub radius: f64,
    /// Height of the circle above the floor in metres.
    pub height: f64,
    /// The point that all cameras look at.
    pub look_at: DVec3,
    /// Width of the pictures in pixels.
    pub width: u32,
    /// Height of the pictures in pixels.
    pub height_px: u32,
    /// Vertical field of view in radians.
    pub fov: f64,
    /// Coefficients k1, k2, p1, p2, k3 of every lens, as in OpenCV.
    pub distortion: [f64; 5],
    /// Deviation of the cameras from an even ring: 0.01 is up to 1 % of the distance and of the focal length, and up to 0.01
    /// radians. Poses and calibration stay exact.
    pub unevenness: f64,
    /// Seed of the unevenness.
    pub seed: u64,
}

impl Default for Ring {
    fn default() -> Self {
        Self {
            count: 20,
            radius: 3.57,
            height: 2.2,
            look_at: DVec3::new(0.0, 0.0, 0.9),
            width: 1024,
            height_px: 768,
            fov: 0.65,
            distortion: [0.0; 5],
            unevenness: 0.01,
            seed: 1,
        }
    }
}

impl Ring {
    /// The ring of the sample that the page shows: the default one with smaller pictures.
    pub fn sample() -> Self {
        Self::default().sized(512, 384)
    }

    /// The same ring with pictures of another size.
    pub fn sized(self, width: u32, height_px: u32) -> Self {
        Self { width, height_px, ..self }
    }

    /// The same ring aimed at another height above the floor, in metres, with another vertical field of view, in radians.
    /// With a narrow one, every camera sees a part of the subject.
    pub fn aimed(self, height: f64, fov: f64) -> Self {
        Self { look_at: self.look_at.with_z(height), fov, ..self }
    }

    /// The cameras, counter-clockwise from the +x axis.
    pub fn cameras(&self) -> Vec<Camera> {
        (0..self.count).map(|i| self.camera(i)).collect()
    }

    fn camera(&self, index: u32) -> Camera {
        let mut random = Random::new(self.seed, u64::from(index));
        let mut uneven = || self.unevenness * random.signed();
        let (sine, cosine) = libm::sincos(TAU * f64::from(index) / f64::from(self.count) + uneven());
        let centre = DVec3::new(self.radius * cosine, self.radius * sine, self.height) * (1.0 + uneven());
        let ahead = (self.look_at - centre).normalize();
        let right = ahead.cross(DVec3::Z).normalize();
        let level = DMat3::from_cols(right, ahead.cross(right), ahead).transpose();
        let rotation = turn(uneven(), uneven(), uneven()) * level;
        let focal = 0.5 * f64::from(self.height_px) / libm::tan(0.5 * self.fov) * (1.0 + uneven());
        let middle = |pixels: u32, off: f64| 0.5 * (f64::from(pixels) - 1.0) + off * f64::from(pixels);
        let k = [
            [focal, 0.0, middle(self.width, uneven())],
            [0.0, focal, middle(self.height_px, uneven())],
            [0.0, 0.0, 1.0],
        ];
        Camera {
            width: self.width,
            height: self.height_px,
            k,
            lens: Lens::brown(self.distortion),
            r: rotation.transpose().to_cols_array_2d(),
            t: (-(rotation * centre)).to_array(),
        }
    }
}

/// The cameras of several rings, one above another.
pub fn dome(rings: &[Ring]) -> Vec<Camera> {
    rings.iter().flat_map(Ring::cameras).collect()
}

/// Indices of neighbouring pairs on a ring (the paper's PCMVS-BINO): of 20 cameras 0, 1, 4, 5, 8, 9, 12, 13, 16, 17.
pub fn pairs(count: usize) -> Vec<usize> {
    (0..count).filter(|i| i % 4 < 2).collect()
}
