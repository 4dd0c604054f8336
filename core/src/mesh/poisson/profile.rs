//! The profile of χ across the surface, and its inverse: the distance to the surface.
//!
//! Near a flat surface χ is a step, smoothed by the quadratic B-spline along each axis. Its profile hardly depends on
//! the orientation of the surface relative to the grid, and the functions here are for the mean over all directions.
//! Distances are in voxels, positive inside. χ is relative to its value on the surface.

/// χ at a distance from the surface: the integral of the quadratic B-spline.
#[inline]
pub(super) fn chi(distance: f32) -> f32 {
    let d = distance.abs();
    let half = if d < 0.5 {
        d * (0.75 - d * d / 3.0)
    } else if d < 1.5 {
        0.5 - (1.5 - d) * (1.5 - d) * (1.5 - d) / 6.0
    } else {
        0.5
    };
    if distance < 0.0 { -half } else { half }
}

/// The distance as a function of χ: scale χ (1 - square χ² - fourth χ⁴) / (1 - pole χ²), fitted up to 1.2 voxels. At
/// larger distances χ is nearly constant, so that it only shows that the surface is farther away.
#[derive(Clone, Copy)]
pub(super) struct Inverse {
    scale: f32,
    square: f32,
    fourth: f32,
    pole: f32,
}

/// For χ as it is solved.
pub(super) const SOLVED: Inverse = Inverse { scale: 1.2813, square: 2.3804, fourth: 3.2709, pole: 3.6083 };

/// For χ after [`super::smooth`].
pub(super) const SMOOTHED: Inverse = Inverse { scale: 1.8493, square: 1.9372, fourth: 1.1542, pole: 2.8104 };

impl Inverse {
    #[inline]
    pub(super) fn distance(self, chi: f32) -> f32 {
        let chi = chi.clamp(-0.5, 0.5);
        let q = chi * chi;
        self.scale * chi * (1.0 - q * (self.square + self.fourth * q)) / (1.0 - self.pole * q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A step along `direction`, smoothed by the quadratic B-spline along each axis, minus 1/2. It is computed as the
    /// integral of its Fourier transform. If `smoothed`, it is also filtered by 2 W - W², where W is the binomial
    /// filter [1 2 1] / 4 along each axis.
    fn step(direction: [f64; 3], distance: f64, smoothed: bool) -> f64 {
        const STEP: f64 = 0.01;
        let cube = |v: f64| v * v * v;
        let transform = |w: f64| {
            let (mut spline, mut binomial) = (1.0, 1.0);
            for d in direction {
                let half = 0.5 * w * d;
                spline *= if half.abs() < 1e-6 { 1.0 } else { cube(libm::sin(half) / half) };
                binomial *= 0.5 + 0.5 * libm::cos(w * d);
            }
            spline * if smoothed { 2.0 * binomial - binomial * binomial } else { 1.0 }
        };
        let sum: f64 =
            (0..10_000).map(|i| (i as f64 + 0.5) * STEP).map(|w| transform(w) * libm::sin(w * distance) / w).sum();
        sum * STEP / core::f64::consts::PI
    }

    #[test]
    fn distances_are_right_whichever_way_the_surface_lies() {
        let directions = [
            [1.0, 0.0, 0.0],
            [0.8, 0.6, 0.0],
            [core::f64::consts::FRAC_1_SQRT_2, core::f64::consts::FRAC_1_SQRT_2, 0.0],
            [0.48, 0.6, 0.64],
        ];
        for direction in directions {
            for distance in (1..=20).map(|i| f64::from(i) * 0.06) {
                let solved = step(direction, distance, false) as f32;
                let smoothed = step(direction, distance, true) as f32;
                let d = distance as f32;
                assert!((chi(d) - solved).abs() < 0.01, "{direction:?} {d}: χ {} {solved}", chi(d));
                for (inverse, chi) in [(SOLVED, solved), (SMOOTHED, smoothed)] {
                    let found = inverse.distance(chi);
                    assert!((found - d).abs() < 0.035, "{direction:?} {d}: {found}");
                    assert_eq!(inverse.distance(-chi), -found);
                }
            }
        }
    }
}
