//! Pictures agree with the cameras and the scene.

use glam::DVec3;
use pcmvs_core::{Camera, hash::Hash64};
use studio::{
    Capture, Faults, Ring, Subject,
    render::{Render, render},
};

const LENS: [f64; 5] = [-0.12, 0.05, 0.002, -0.001, 0.01];

fn camera(distortion: [f64; 5]) -> Camera {
    Ring { distortion, ..Ring::default() }.sized(320, 240).cameras()[3]
}

fn bilinear<const N: usize>(at: impl Fn(usize) -> [f64; N], width: u32, x: f64, y: f64) -> [f64; N] {
    let (i, j) = (x.floor(), y.floor());
    let (u, v) = (x - i, y - j);
    let index = j as usize * width as usize + i as usize;
    let corners = [at(index), at(index + 1), at(index + width as usize), at(index + width as usize + 1)];
    let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
    core::array::from_fn(|c| corners.iter().zip(weights).map(|(p, w)| p[c] * w).sum())
}

fn coverage(picture: &Render, x: f64, y: f64) -> f64 {
    bilinear(|i| [picture.coverage[i]], 320, x, y)[0]
}

/// The sphere's outline, projected by the core's camera, lies on the mask's half level to a tenth of a pixel.
#[test]
fn outlines_lie_where_points_project() {
    for lens in [[0.0; 5], LENS] {
        let camera = camera(lens);
        let picture = render(&Subject::Sphere.at(0.0), &camera);
        let (centre, radius) = (DVec3::new(0.0, 0.0, 0.9), 0.45);
        let to = centre - camera.centre();
        let distance = to.length();
        // Tangent rays touch the sphere on a circle nearer than its middle.
        let middle = centre - to * (radius * radius / (distance * distance));
        let across = radius * libm::sqrt(1.0 - radius * radius / (distance * distance));
        let u = to.any_orthogonal_vector().normalize();
        let v = to.cross(u).normalize();
        let mut total = 0.0;
        for i in 0..360 {
            let (s, c) = libm::sincos(f64::from(i).to_radians());
            let (pixel, _) = camera.project(middle + (u * c + v * s) * across).unwrap();
            let at = |dx: f64, dy: f64| coverage(&picture, pixel.x + dx, pixel.y + dy);
            let (gx, gy) = (at(0.5, 0.0) - at(-0.5, 0.0), at(0.0, 0.5) - at(0.0, -0.5));
            let off = (at(0.0, 0.0) - 0.5) / libm::sqrt(gx * gx + gy * gy);
            assert!(off.abs() < 0.1, "{off} pixels at {pixel}");
            total += off;
        }
        assert!((total / 360.0).abs() < 0.01, "{}", total / 360.0);
    }
}

/// Every surface point that a camera sees is covered where it projects, and what projects well outside is backdrop.
#[test]
fn seen_points_are_drawn() {
    let scene = Subject::Figure.at(0.0);
    let camera = camera(LENS);
    let picture = render(&scene, &camera);
    let mut inside = vec![false; picture.coverage.len()];
    for (p, n) in scene.surface_points(20_000, 1) {
        let (pixel, _) = camera.project(p).unwrap();
        let index = (pixel.y + 0.5) as usize * 320 + (pixel.x + 0.5) as usize;
        inside[index] = true;
        if studio::score::sees(&scene, &camera, p, n) {
            assert!(picture.coverage[index] > 0.0, "{pixel}");
        }
    }
    let full = picture.coverage.iter().filter(|c| **c == 1.0).count();
    let hit = picture.coverage.iter().zip(&inside).filter(|(c, hit)| **c == 1.0 && **hit).count();
    assert!(full > 3000 && hit as f64 > 0.9 * full as f64, "{hit} of {full}");
    assert!(picture.coverage.iter().zip(&inside).all(|(c, hit)| *c > 0.0 || !hit));
}

/// A picture through a lens is the picture without it, resampled.
#[test]
fn distortion_moves_pixels_and_nothing_else() {
    let scene = Subject::Figure.at(0.0);
    let (straight, bent) = (camera([0.0; 5]), camera(LENS));
    let (a, b) = (render(&scene, &straight), render(&scene, &bent));
    let (mut off, mut moved, mut count) = (0.0, 0.0, 0);
    for y in 20..220 {
        for x in 40..280 {
            let p = bent.distort_pixel(glam::DVec2::new(f64::from(x), f64::from(y)));
            let index = (y * 320 + x) as usize;
            let resampled = bilinear(|i| b.rgb[i], 320, p.x, p.y);
            (0..3).for_each(|c| off += (resampled[c] - a.rgb[index][c]).abs());
            (0..3).for_each(|c| moved += (b.rgb[index][c] - a.rgb[index][c]).abs());
            count += 3;
        }
    }
    let (off, moved) = (255.0 * off / f64::from(count), 255.0 * moved / f64::from(count));
    assert!(off < 0.8 && moved > 2.0 * off, "{off} levels, {moved} without resampling");
}

/// The same bytes every time and on every machine.
#[test]
fn bytes_are_golden() {
    let cameras = Ring { count: 3, distortion: LENS, ..Ring::default() }.sized(96, 72).cameras();
    let faults = Faults { noise: 2.0, gain: 0.1, blur: 0.7, clock: 0.02, ..Faults::default() };
    let record = || Capture::new(Subject::Figure, &cameras, &[0.0, 0.5], &faults);
    let hash = |capture: &Capture| {
        let mut hash = Hash64::default();
        for frame in &capture.frames {
            for (picture, mask) in frame.images.iter().zip(&frame.masks) {
                picture.rgb.iter().chain(mask.as_ref().unwrap()).for_each(|b| hash.word(u64::from(*b)));
            }
        }
        hash.finish()
    };
    let first = hash(&record());
    assert_eq!(first, hash(&record()));
    assert_eq!(first, 0, "{first:#018x}");
}
