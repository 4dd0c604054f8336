//! Lenses follow OpenCV's formulas, written here as its documentation prints them, and their inverses lead back.

#![allow(clippy::disallowed_methods, reason = "no result depends on the tests' own numbers")]

use super::*;
use alloc::vec::Vec;

/// A lens with all coefficients, like that of an action camera, and another one in which the prism dominates.
const OPENCV: [[f64; 12]; 4] = [
    [-0.21, 0.08, 0.002, -0.001, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [0.52, -2.6, 4e-4, -2e-4, 1.45, 0.39, -2.4, 1.38, 0.0, 0.0, 0.0, 0.0],
    [-0.1, 0.03, 0.002, 0.001, -0.004, 0.05, -0.02, 0.003, 0.004, -0.002, -0.003, 0.001],
    [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.02, 0.01, -0.01, -0.02],
];
const FISHEYE: [[f64; 4]; 3] = [[-0.029225, 0.020834, -0.0319416, 0.0165934], [0.0; 4], [0.09, -0.05, 0.02, -0.004]];

fn lenses() -> Vec<Lens> {
    OPENCV.into_iter().map(Lens::OpenCv).chain(FISHEYE.into_iter().map(Lens::Fisheye)).collect()
}

/// Positions up to a radius of 0.8, which is 39 degrees.
fn positions() -> impl Iterator<Item = DVec2> {
    (0..81).map(|i| DVec2::new(f64::from(i % 9 - 4), f64::from(i / 9 - 4)) * 0.141)
}

#[test]
fn opencv_is_the_rational_model_with_thin_prism() {
    for c in OPENCV {
        let [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4] = c;
        for DVec2 { x, y } in positions() {
            let (r2, r4, r6) = (x * x + y * y, (x * x + y * y).powi(2), (x * x + y * y).powi(3));
            let radial = (1.0 + k1 * r2 + k2 * r4 + k3 * r6) / (1.0 + k4 * r2 + k5 * r4 + k6 * r6);
            let x1 = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + s1 * r2 + s2 * r4;
            let y1 = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + s3 * r2 + s4 * r4;
            let found = Lens::OpenCv(c).distort(DVec2::new(x, y));
            assert!((found - DVec2::new(x1, y1)).length() < 1e-14, "{c:?} at {x} {y}");
        }
    }
}

#[test]
fn fisheye_is_equidistant_with_a_polynomial() {
    for [k1, k2, k3, k4] in FISHEYE {
        for p in positions() {
            let r = p.length();
            let a = libm::atan2(r, 1.0);
            let d = a + k1 * a.powi(3) + k2 * a.powi(5) + k3 * a.powi(7) + k4 * a.powi(9);
            let expected = if r > 0.0 { p * d / r } else { DVec2::ZERO };
            assert!((Lens::Fisheye([k1, k2, k3, k4]).distort(p) - expected).length() < 1e-14, "{p}");
        }
    }
}

#[test]
fn derivatives_are_those_of_the_distortion() {
    let h = 1e-6;
    for lens in lenses() {
        for p in positions() {
            let by = |d: DVec2| (lens.distort(p + d) - lens.distort(p - d)) / (2.0 * h);
            let expected = DMat2::from_cols(by(DVec2::X * h), by(DVec2::Y * h));
            assert!(lens.derivative(p).abs_diff_eq(expected, 1e-8), "{lens:?} at {p}");
        }
    }
}

#[test]
fn what_is_distorted_comes_back() {
    for lens in lenses() {
        for p in positions() {
            let back = lens.undistort(lens.distort(p));
            assert!((back - p).length() < 1e-12, "{lens:?} at {p}: {back}");
        }
    }
    // 88 degrees from the axis.
    let (lens, p) = (Lens::Fisheye(FISHEYE[1]), DVec2::new(20.0, 20.2));
    assert!((lens.undistort(lens.distort(p)) - p).length() < 1e-9);
    assert!(lens.undistort(DVec2::new(40.0, 1.0)).is_finite());
}

#[test]
fn folds_and_poles_are_found() {
    let brown = |k1: f64| Lens::brown([k1, 0.0, 0.0, 0.0, 0.0]);
    // r (1 - r² / 3) grows up to r = 1, where it is 2/3.
    let lens = brown(-1.0 / 3.0);
    assert!((lens.fold_over(4.0) - 1.0).abs() < 0.01);
    assert!(lens.fold_over(0.9).is_infinite());
    assert!(lens.reaches(0.66) && !lens.reaches(0.67));
    assert!(brown(0.2).reaches(100.0));
    // r / (1 - r²) goes to infinity at r = 1, and comes back from the other side.
    let pole = Lens::OpenCv([0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!((pole.fold_over(4.0) - 1.0).abs() < 0.01);
    // r / (1 + r²) turns back at r = 1, where it is 1/2.
    let limit = Lens::OpenCv([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(limit.reaches(0.49) && !limit.reaches(0.51));
    // A fisheye without coefficients never folds, but sees at most 90 degrees at each side.
    assert!(Lens::Fisheye([0.0; 4]).reaches(3.0));
    // θ (1 - θ²) turns back at 1 / √3, where it is 0.385.
    let lens = Lens::Fisheye([-1.0, 0.0, 0.0, 0.0]);
    assert!(lens.reaches(0.38) && !lens.reaches(0.39));
}
