//! Lens models, as in OpenCV. They map normalised image coordinates, x/z and y/z in the camera's axes, to the distorted
//! ones that K turns into pixels.

use glam::{DMat2, DVec2};

/// Steps in which the radii of a picture are looked at.
const STEPS: u32 = 1024;
/// Most steps of Newton's method. Even at 89 degrees a fisheye needs fewer.
const NEWTON_STEPS: u32 = 24;

/// How a lens departs from a pinhole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lens {
    /// OpenCV's coefficients in its order: k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4. With only the first five it is
    /// the model of Brown and Conrady. k4 to k6 make it the rational model, s1 to s4 add the thin prism.
    OpenCv([f64; 12]),
    /// OpenCV's fisheye, which others call equidistant or Kannala-Brandt: k1, k2, k3, k4. An angle θ from the axis is seen
    /// at the radius θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸).
    Fisheye([f64; 4]),
}

impl Lens {
    /// A lens that does not distort.
    pub const NONE: Self = Self::OpenCv([0.0; 12]);

    /// The model of Brown and Conrady: k1, k2, p1, p2, k3.
    pub const fn brown([k1, k2, p1, p2, k3]: [f64; 5]) -> Self {
        Self::OpenCv([k1, k2, p1, p2, k3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// All coefficients of the model.
    pub fn coefficients(&self) -> &[f64] {
        match self {
            Self::OpenCv(coefficients) => coefficients,
            Self::Fisheye(coefficients) => coefficients,
        }
    }

    /// Whether pictures differ from those of a pinhole.
    pub fn is_distorted(&self) -> bool {
        *self != Self::NONE
    }

    /// Whether the model is that of Brown and Conrady.
    pub(crate) fn is_brown(&self) -> bool {
        matches!(self, Self::OpenCv([_, _, _, _, _, rest @ ..]) if *rest == [0.0; 7])
    }

    /// Applies the distortion.
    pub fn distort(&self, p: DVec2) -> DVec2 {
        let r2 = p.length_squared();
        let scale = self.scale(r2);
        match *self {
            Self::OpenCv([_, _, p1, p2, _, _, _, _, s1, s2, s3, s4]) => DVec2::new(
                p.x * scale + 2.0 * p1 * p.x * p.y + p2 * (r2 + 2.0 * p.x * p.x) + r2 * (s1 + r2 * s2),
                p.y * scale + p1 * (r2 + 2.0 * p.y * p.y) + 2.0 * p2 * p.x * p.y + r2 * (s3 + r2 * s4),
            ),
            Self::Fisheye(_) => p * scale,
        }
    }

    /// The factor of the radius at the squared radius `r2`.
    fn scale(&self, r2: f64) -> f64 {
        match *self {
            Self::OpenCv([k1, k2, _, _, k3, k4, k5, k6, ..]) => {
                (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1.0 + r2 * (k4 + r2 * (k5 + r2 * k6)))
            }
            Self::Fisheye([k1, k2, k3, k4]) => {
                let (angle, r) = angle(r2);
                let a2 = angle * angle;
                // Near the axis the angle is the radius, but for its third power.
                let straight = if r > 1e-8 { angle / r } else { 1.0 };
                straight * (1.0 + a2 * (k1 + a2 * (k2 + a2 * (k3 + a2 * k4))))
            }
        }
    }

    /// The derivative of [`Self::scale`].
    fn slope(&self, r2: f64) -> f64 {
        match *self {
            Self::OpenCv([k1, k2, _, _, k3, k4, k5, k6, ..]) => {
                let below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
                let above = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3);
                (above - self.scale(r2) * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6))) / below
            }
            Self::Fisheye([k1, ..]) => {
                let r = libm::sqrt(r2);
                if r > 1e-4 {
                    (self.growth(r2) - self.scale(r2)) / (2.0 * r2)
                } else {
                    // The first terms of atan(r) / r = 1 - r² / 3 + ...
                    k1 - 1.0 / 3.0
                }
            }
        }
    }

    /// How fast the distorted radius grows with the radius, without tangential terms and thin prism.
    fn growth(&self, r2: f64) -> f64 {
        match *self {
            Self::OpenCv([k1, k2, _, _, k3, k4, k5, k6, ..]) => {
                let below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6));
                let brown = 1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3));
                // Beyond a pole the radius comes back from infinity.
                if below > 0.0 {
                    (brown - self.scale(r2) * 2.0 * r2 * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6))) / below
                } else {
                    -1.0
                }
            }
            Self::Fisheye([k1, k2, k3, k4]) => {
                let (angle, _) = angle(r2);
                let a2 = angle * angle;
                (1.0 + a2 * (3.0 * k1 + a2 * (5.0 * k2 + a2 * (7.0 * k3 + a2 * 9.0 * k4)))) / (1.0 + r2)
            }
        }
    }

    /// Derivative of [`Self::distort`].
    pub(crate) fn derivative(&self, p: DVec2) -> DMat2 {
        let r2 = p.length_squared();
        let (scale, slope) = (self.scale(r2), 2.0 * self.slope(r2));
        let radial = DMat2::from_cols(
            DVec2::new(scale + slope * p.x * p.x, slope * p.x * p.y),
            DVec2::new(slope * p.x * p.y, scale + slope * p.y * p.y),
        );
        match *self {
            Self::OpenCv([_, _, p1, p2, _, _, _, _, s1, s2, s3, s4]) => {
                let mixed = 2.0 * (p1 * p.x + p2 * p.y);
                let tangential = DMat2::from_cols(
                    DVec2::new(2.0 * p1 * p.y + 6.0 * p2 * p.x, mixed),
                    DVec2::new(mixed, 6.0 * p1 * p.y + 2.0 * p2 * p.x),
                );
                let prism = DVec2::new(s1 + 2.0 * r2 * s2, s3 + 2.0 * r2 * s4) * 2.0;
                radial + tangential + DMat2::from_cols(prism * p.x, prism * p.y)
            }
            Self::Fisheye(_) => radial,
        }
    }

    /// Inverts the distortion by Newton's method. From the distorted position, which is nearer to the axis than the result
    /// where the radius grows ever more slowly and farther where it grows ever faster, every step leads towards the result.
    pub fn undistort(&self, distorted: DVec2) -> DVec2 {
        let mut p = distorted;
        if self.is_distorted() {
            for _ in 0..NEWTON_STEPS {
                let derivative = self.derivative(p);
                let step = derivative.inverse() * (distorted - self.distort(p));
                // Where the model folds the picture, nothing leads on.
                if !(derivative.determinant() > 0.0) || !step.is_finite() {
                    break;
                }
                p += step;
                if step.length_squared() < 1e-30 {
                    break;
                }
            }
        }
        p
    }

    /// The squared radius from which the distorted radius no longer grows; infinite if it grows up to the squared radius
    /// `farthest`. Tangential terms and thin prism are too small to fold the picture.
    pub(crate) fn fold_over(&self, farthest: f64) -> f64 {
        let step = farthest / f64::from(STEPS);
        let fold = (1..=STEPS).map(|i| f64::from(i) * step).find(|&r2| !(self.growth(r2) > 0.0));
        fold.map_or(f64::INFINITY, |r2| r2 - step)
    }

    /// Whether every distorted radius up to this one belongs to one direction in front of the camera. What a fisheye sees
    /// from 90 degrees on has no place in the picture of a pinhole, and is not asked for.
    pub(crate) fn reaches(&self, radius: f64) -> bool {
        for i in 1..STEPS {
            let r = libm::tan(f64::from(i) * core::f64::consts::FRAC_PI_2 / f64::from(STEPS));
            if !(self.growth(r * r) > 0.0) {
                return false;
            }
            if r * self.scale(r * r) >= radius {
                return true;
            }
        }
        matches!(self, Self::Fisheye(_))
    }
}

/// Angle from the axis, and radius.
fn angle(r2: f64) -> (f64, f64) {
    let r = libm::sqrt(r2);
    (libm::atan(r), r)
}

#[cfg(test)]
mod tests;
