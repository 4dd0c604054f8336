//! Calibrated cameras: the form that the host passes in ([`Camera`]) and the undistorted form that the stages use
//! ([`Pinhole`]).

use crate::lens::Lens;
use alloc::{format, string::String};
use glam::{DMat3, DVec2, DVec3, Vec3};

/// A calibrated camera.
///
/// A world point X projects to the pixel `x = K · distort(R X + t)`, as in OpenCV. Camera axes are x right, y down and
/// z forward. The centre of the first pixel is at (0, 0). Matrices are row-major. Lengths are in the scene's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Width of its pictures in pixels.
    pub width: u32,
    /// Height of its pictures in pixels.
    pub height: u32,
    /// Intrinsic matrix. Its last row is 0 0 1. Skew is allowed.
    pub k: [[f64; 3]; 3],
    /// Distortion.
    pub lens: Lens,
    /// Rotation, world to camera.
    pub r: [[f64; 3]; 3],
    /// Translation, world to camera.
    pub t: [f64; 3],
}

/// A matrix from its rows.
pub(crate) fn matrix(rows: &[[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(rows).transpose()
}

/// The factor of a rotation that was scaled: its rows have the same length and are perpendicular.
fn scale_of(r: &DMat3) -> Option<f64> {
    // Rounded for people.
    let scale = libm::round(libm::cbrt(r.determinant()) * 1e6) / 1e6;
    let off = *r * r.transpose() * (1.0 / (scale * scale)) - DMat3::IDENTITY;
    off.to_cols_array().into_iter().all(|v| v.abs() < 1e-3).then_some(scale)
}

impl Camera {
    /// Checks the calibration. The error states what is wrong and how to correct it.
    pub fn check(&self) -> Result<(), String> {
        let numbers = self.k.iter().chain(&self.r).flatten().chain(&self.t).chain(self.lens.coefficients());
        if numbers.into_iter().any(|v| !v.is_finite()) {
            return Err(String::from(
                "K, R, t or the distortion contains a number that is not finite: calibrate again",
            ));
        }
        if self.width == 0 || self.height == 0 {
            return Err(format!("the calibrated size is {} x {} pixels", self.width, self.height));
        }
        let k = &self.k;
        if k[2] != [0.0, 0.0, 1.0] || k[1][0] != 0.0 {
            return Err(String::from("K must be upper triangular with last row 0 0 1"));
        }
        if k[0][0] <= 0.0 || k[1][1] <= 0.0 {
            return Err(format!(
                "K is singular or mirrors the picture: its focal lengths are {} and {}, but both must be positive",
                k[0][0], k[1][1]
            ));
        }
        let r = matrix(&self.r);
        if r.determinant() < 0.0 {
            return Err(String::from(
                "R reflects (its determinant is -1): an axis is flipped, negate the matching row of R and t",
            ));
        }
        let off =
            (r * r.transpose() - DMat3::IDENTITY).to_cols_array().into_iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        if off > 1e-3 {
            if let Some(scale) = scale_of(&r) {
                return Err(format!(
                    "R is {scale} times a rotation: divide R by that, and t, too, if both were scaled together"
                ));
            }
            return Err(format!("R is not a rotation (R Rᵀ is off by {off:.1e}): export it with more digits"));
        }
        if self.lens.is_distorted() && !self.lens.reaches(self.nearest_edge()) {
            return Err(String::from(
                "the lens model folds the picture before its nearest edge, so that several directions have the same pixel: \
                 check that the coefficients are in the order of this model, or calibrate again",
            ));
        }
        Ok(())
    }

    /// Distance from the principal point to the nearest edge of the picture, in normalised coordinates.
    fn nearest_edge(&self) -> f64 {
        let of = |size: u32, principal: f64, focal: f64| {
            (principal + 0.5).abs().min((f64::from(size) - 0.5 - principal).abs()) / focal
        };
        of(self.width, self.k[0][2], self.k[0][0]).min(of(self.height, self.k[1][2], self.k[1][1]))
    }

    /// Centre of projection in world coordinates.
    pub fn centre(&self) -> DVec3 {
        -(matrix(&self.r).transpose() * DVec3::from_array(self.t))
    }

    /// Unit viewing direction in world coordinates.
    pub fn direction(&self) -> DVec3 {
        DVec3::from_array(self.r[2])
    }

    /// The pixel and the depth of a world point, or `None` if the point is behind the camera.
    pub fn project(&self, world: DVec3) -> Option<(DVec2, f64)> {
        let c = matrix(&self.r) * world + DVec3::from_array(self.t);
        if c.z <= 0.0 {
            return None;
        }
        let pixel = matrix(&self.k) * self.lens.distort(DVec2::new(c.x / c.z, c.y / c.z)).extend(1.0);
        Some((pixel.truncate(), c.z))
    }

    /// Normalised coordinates K⁻¹ (x, y, 1) of an ideal (undistorted) pixel.
    pub fn normalise(&self, pixel: DVec2) -> DVec2 {
        let k = &self.k;
        let y = (pixel.y - k[1][2]) / k[1][1];
        DVec2::new((pixel.x - k[0][2] - k[0][1] * y) / k[0][0], y)
    }

    /// Position in the real (distorted) picture of an ideal (undistorted) pixel.
    pub fn distort_pixel(&self, pixel: DVec2) -> DVec2 {
        (matrix(&self.k) * self.lens.distort(self.normalise(pixel)).extend(1.0)).truncate()
    }
}

/// A camera without lens distortion, in single precision and relative to the rig's origin.
///
/// It has the same K and picture size as its [`Camera`]. Pictures are resampled to it once (see [`crate::view`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Centre of projection.
    pub centre: Vec3,
    /// Mean focal length in pixels: a surface at depth z has a pixel footprint of z / focal.
    pub focal: f32,
    /// Rows of K·R.
    rows: [Vec3; 3],
    /// K·(R·origin + t).
    offset: Vec3,
    /// Columns of (K·R)⁻¹, which maps the pixel (u, v, 1) to the direction of unit depth.
    columns: [Vec3; 3],
}

impl Pinhole {
    /// The camera relative to `origin`, without its distortion.
    pub fn new(camera: &Camera, origin: DVec3) -> Self {
        let (k, r) = (matrix(&camera.k), matrix(&camera.r));
        let kr = k * r;
        let inverse = r.transpose() * k.inverse();
        let single = |v: DVec3| v.as_vec3();
        let t = kr.transpose();
        Self {
            width: camera.width,
            height: camera.height,
            centre: single(camera.centre() - origin),
            focal: libm::sqrt(camera.k[0][0] * camera.k[1][1]) as f32,
            rows: [single(t.x_axis), single(t.y_axis), single(t.z_axis)],
            offset: single(k * (r * origin + DVec3::from_array(camera.t))),
            columns: [single(inverse.x_axis), single(inverse.y_axis), single(inverse.z_axis)],
        }
    }

    /// Pixel (x, y) and depth (z) of a point. The pixel is meaningless if the depth is not positive.
    #[inline]
    pub fn project(&self, p: Vec3) -> Vec3 {
        let z = self.rows[2].dot(p) + self.offset.z;
        Vec3::new((self.rows[0].dot(p) + self.offset.x) / z, (self.rows[1].dot(p) + self.offset.y) / z, z)
    }

    /// Index of the pixel that shows a point, row after row, and the point's depth. `None` if the point is not before the
    /// camera or beside its picture.
    #[inline]
    pub fn pixel(&self, p: Vec3) -> Option<(usize, f32)> {
        let Vec3 { x, y, z } = self.project(p);
        let (x, y) = (x + 0.5, y + 0.5);
        let shown = z > 0.0 && x >= 0.0 && y >= 0.0 && x < self.width as f32 && y < self.height as f32;
        shown.then(|| (y as usize * self.width as usize + x as usize, z))
    }

    /// Direction of a pixel's ray, scaled so that the point `centre + depth * ray` has that depth.
    #[inline]
    pub fn ray(&self, u: f32, v: f32) -> Vec3 {
        self.columns[0] * u + self.columns[1] * v + self.columns[2]
    }

    /// The point on a pixel's ray at a depth.
    #[inline]
    pub fn unproject(&self, u: f32, v: f32, depth: f32) -> Vec3 {
        self.centre + self.ray(u, v) * depth
    }

    /// Depth of a point.
    #[inline]
    pub fn depth(&self, p: Vec3) -> f32 {
        self.rows[2].dot(p) + self.offset.z
    }

    /// Footprint: the size of a pixel on a surface that faces the camera at a depth.
    #[inline]
    pub fn footprint(&self, depth: f32) -> f32 {
        depth / self.focal
    }

    /// The camera of a part of the picture, from its first column and row and its width and height.
    pub(crate) fn part(&self, first: [u32; 2], [width, height]: [u32; 2]) -> Self {
        let [x, y] = first.map(|v| v as f32);
        let [across, down, ahead] = self.rows;
        let offset = Vec3::new(self.offset.x - self.offset.z * x, self.offset.y - self.offset.z * y, self.offset.z);
        Self {
            width,
            height,
            rows: [across - ahead * x, down - ahead * y, ahead],
            offset,
            columns: [self.columns[0], self.columns[1], self.ray(x, y)],
            ..*self
        }
    }

    /// The camera of the picture at half the resolution, in which each pixel is the mean of 2 x 2 pixels.
    pub fn halved(&self) -> Self {
        // u' = (u - 1/2) / 2 maps the centres of 2 x 2 squares to integers.
        let scale = |row: Vec3, z: Vec3| (row - z * 0.5) * 0.5;
        let offset = |v: f32| (v - self.offset.z * 0.5) * 0.5;
        Self {
            width: self.width / 2,
            height: self.height / 2,
            focal: self.focal * 0.5,
            rows: [scale(self.rows[0], self.rows[2]), scale(self.rows[1], self.rows[2]), self.rows[2]],
            offset: Vec3::new(offset(self.offset.x), offset(self.offset.y), self.offset.z),
            columns: [
                self.columns[0] * 2.0,
                self.columns[1] * 2.0,
                self.columns[2] + (self.columns[0] + self.columns[1]) * 0.5,
            ],
            ..*self
        }
    }

    /// The camera of the picture at a level of the image pyramid, where 0 is full resolution.
    pub fn at_octave(&self, octave: u32) -> Self {
        (0..octave).fold(*self, |camera, _| camera.halved())
    }

    /// The rows of K·R, and K·(R·origin + t). The plane sweep derives its warps from them.
    pub fn projection(&self) -> ([Vec3; 3], Vec3) {
        (self.rows, self.offset)
    }
}
