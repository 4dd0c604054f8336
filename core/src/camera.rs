//! Calibrated cameras: what the host gives ([`Camera`]) and the undistorted form that the stages use ([`Pinhole`]).

use alloc::{format, string::String};
use glam::{DMat3, DVec2, DVec3, Vec3};

/// A calibrated camera. World to pixel is `x = K · distort(R X + t)`: x right, y down, z forward, the first pixel's
/// centre at (0, 0). Matrices are row-major. Lengths are in the scene's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Pixels in a row of its pictures.
    pub width: u32,
    /// Rows of its pictures.
    pub height: u32,
    /// Intrinsic matrix; last row 0 0 1. Skew is allowed.
    pub k: [[f64; 3]; 3],
    /// OpenCV's coefficients k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
    /// Rotation, world to camera.
    pub r: [[f64; 3]; 3],
    /// Translation, world to camera.
    pub t: [f64; 3],
}

fn matrix(rows: &[[f64; 3]; 3]) -> DMat3 {
    DMat3::from_cols_array_2d(rows).transpose()
}

impl Camera {
    /// Says what is wrong with the calibration and what to do, if anything is.
    pub fn check(&self) -> Result<(), String> {
        let numbers = self.k.iter().chain(&self.r).flatten().chain(&self.t).chain(&self.distortion);
        if numbers.into_iter().any(|v| !v.is_finite()) {
            return Err(String::from("K, R, t or the distortion holds a number that is not finite: calibrate again"));
        }
        if self.width == 0 || self.height == 0 {
            return Err(format!("the calibrated size is {} x {} pixels", self.width, self.height));
        }
        let k = &self.k;
        if k[2] != [0.0, 0.0, 1.0] || k[1][0] != 0.0 {
            return Err(String::from("K must be upper triangular with last row 0 0 1"));
        }
        if k[0][0] <= 0.0 || k[1][1] <= 0.0 {
            return Err(format!("K is singular or mirrors: focal lengths are {} and {}", k[0][0], k[1][1]));
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
            return Err(format!("R is not a rotation (R Rᵀ is off by {off:.1e}): export it with more digits"));
        }
        Ok(())
    }

    /// Centre of projection in the world.
    pub fn centre(&self) -> DVec3 {
        -(matrix(&self.r).transpose() * DVec3::from_array(self.t))
    }

    /// Viewing direction (unit) in the world.
    pub fn direction(&self) -> DVec3 {
        DVec3::from_array(self.r[2])
    }

    /// Pixel of a world point and its depth, or `None` behind the camera.
    pub fn project(&self, world: DVec3) -> Option<(DVec2, f64)> {
        let c = matrix(&self.r) * world + DVec3::from_array(self.t);
        if c.z <= 0.0 {
            return None;
        }
        let pixel = matrix(&self.k) * self.distort(DVec2::new(c.x / c.z, c.y / c.z)).extend(1.0);
        Some((pixel.truncate(), c.z))
    }

    /// OpenCV's lens distortion of normalised image coordinates.
    pub fn distort(&self, p: DVec2) -> DVec2 {
        let [k1, k2, p1, p2, k3] = self.distortion;
        let r2 = p.length_squared();
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        DVec2::new(
            p.x * radial + 2.0 * p1 * p.x * p.y + p2 * (r2 + 2.0 * p.x * p.x),
            p.y * radial + p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y,
        )
    }

    /// Whether the lens bends lines at all.
    pub fn is_distorted(&self) -> bool {
        self.distortion != [0.0; 5]
    }

    /// Normalised coordinates K⁻¹ (x, y, 1) of an ideal pixel.
    pub fn normalise(&self, pixel: DVec2) -> DVec2 {
        let k = &self.k;
        let y = (pixel.y - k[1][2]) / k[1][1];
        DVec2::new((pixel.x - k[0][2] - k[0][1] * y) / k[0][0], y)
    }

    /// Where the ideal (undistorted) pixel lies in the real picture.
    pub fn distort_pixel(&self, pixel: DVec2) -> DVec2 {
        (matrix(&self.k) * self.distort(self.normalise(pixel)).extend(1.0)).truncate()
    }
}

/// A camera without lens distortion in single precision, relative to the rig's origin. Same K and size as its
/// [`Camera`]; pictures are resampled to it once (see [`crate::view`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Centre of projection.
    pub centre: Vec3,
    /// Mean focal length in pixels: a surface at depth z has a pixel footprint of z / focal.
    pub focal: f32,
    /// Rows of K·R.
    rows: [Vec3; 3],
    /// K·(R·origin + t).
    offset: Vec3,
    /// Columns of (K·R)⁻¹: pixel (u, v, 1) to the direction whose depth is one.
    columns: [Vec3; 3],
}

impl Pinhole {
    /// The camera seen from `origin`, ignoring its distortion.
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

    /// Pixel (x, y) and depth (z) of a point; the pixel is meaningless where the depth is not positive.
    #[inline]
    pub fn project(&self, p: Vec3) -> Vec3 {
        let z = self.rows[2].dot(p) + self.offset.z;
        Vec3::new((self.rows[0].dot(p) + self.offset.x) / z, (self.rows[1].dot(p) + self.offset.y) / z, z)
    }

    /// Direction of a pixel's ray, scaled so that `centre + depth * ray` has that depth.
    #[inline]
    pub fn ray(&self, u: f32, v: f32) -> Vec3 {
        self.columns[0] * u + self.columns[1] * v + self.columns[2]
    }

    /// The point that a pixel sees at a depth.
    #[inline]
    pub fn unproject(&self, u: f32, v: f32, depth: f32) -> Vec3 {
        self.centre + self.ray(u, v) * depth
    }

    /// Depth of a point.
    #[inline]
    pub fn depth(&self, p: Vec3) -> f32 {
        self.rows[2].dot(p) + self.offset.z
    }

    /// Size of a pixel on a surface that faces the camera at a depth.
    #[inline]
    pub fn footprint(&self, depth: f32) -> f32 {
        depth / self.focal
    }

    /// The camera of a picture at half the resolution, whose pixels are means of 2 x 2.
    pub fn halved(&self) -> Self {
        // u' = (u - 1/2) / 2, so that centres of 2 x 2 squares become integers.
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

    /// Rows of K·R and K·(R·origin + t), from which plane-induced homographies are made.
    pub fn projection(&self) -> ([Vec3; 3], Vec3) {
        (self.rows, self.offset)
    }
}
