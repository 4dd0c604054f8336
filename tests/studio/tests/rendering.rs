//! Pictures agree with the cameras and the solid.

use glam::{DVec2, DVec3};
use pcmvs_core::{Camera, hash::Hash64};
use studio::{Capture, Faults, Ring, Subject, render::render};

const LENS: [f64; 5] = [-0.3, 0.1, 0.004, -0.003, 0.02];

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

/// The outline of the sphere in the picture as a convex polygon, projected by the core's camera.
fn outline(camera: &Camera) -> Vec<DVec2> {
    let (centre, radius) = (DVec3::new(0.0, 0.0, 0.9), 0.45);
    let to = centre - camera.centre();
    // Tangent rays touch the sphere on a circle in front of its centre.
    let nearer = radius * radius / to.length_squared();
    let (middle, across) = (centre - to * nearer, radius * libm::sqrt(1.0 - nearer));
    let u = to.any_orthogonal_vector().normalize();
    let v = to.cross(u).normalize();
    let point = |i: i32| {
        let (s, c) = libm::sincos(core::f64::consts::TAU * f64::from(i) / 1024.0);
        camera.project(middle + (u * c + v * s) * across).unwrap().0
    };
    (0..1024).map(point).collect()
}

/// Coverage is the area of each pixel inside the outline, with errors below a tenth of a pixel and a far smaller mean.
#[test]
fn outlines_lie_where_points_project() {
    const LINES: u32 = 32;
    for lens in [[0.0; 5], LENS] {
        let camera = camera(lens);
        let picture = render(&Subject::Sphere.at(0.0), &camera);
        let outline = outline(&camera);
        let mut area = vec![0.0; picture.coverage.len()];
        for line in 0..240 * LINES {
            let y = (f64::from(line) + 0.5) / f64::from(LINES) - 0.5;
            let (mut left, mut right) = (f64::MAX, f64::MIN);
            for (i, a) in outline.iter().enumerate() {
                let b = outline[(i + 1) % outline.len()];
                if (a.y < y) != (b.y < y) {
                    let x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            for x in 0..320 {
                let (from, to) = (left.max(f64::from(x) - 0.5), right.min(f64::from(x) + 0.5));
                area[(line / LINES * 320 + x) as usize] += (to - from).max(0.0) / f64::from(LINES);
            }
        }
        let edge: Vec<f64> = picture
            .coverage
            .iter()
            .zip(&area)
            .filter(|(c, a)| (**c > 0.0 && **c < 1.0) || (**a > 0.0 && **a < 1.0))
            .map(|(c, a)| c - a)
            .collect();
        let mean = |values: &dyn Fn(&f64) -> f64| edge.iter().map(values).sum::<f64>() / edge.len() as f64;
        let (bias, miss) = (mean(&|v| *v), mean(&|v| v.abs()));
        let worst = edge.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        assert!(edge.len() > 250 && worst < 0.1, "{worst} of {}", edge.len());
        assert!(bias.abs() < 0.01 && miss < 0.03, "{bias}, {miss}");
    }
}

/// Every visible surface point is drawn where it projects, and everything drawn is where visible surface points project.
/// (A sliver smaller than a sample may appear in the next pixel.)
#[test]
fn seen_points_are_drawn() {
    let scene = Subject::Figure.at(0.0);
    let camera = camera(LENS);
    let picture = render(&scene, &camera);
    let mut seen = vec![false; picture.coverage.len()];
    for (p, n) in scene.surface_points(20_000, 1) {
        let (pixel, _) = camera.project(p).unwrap();
        let index = (pixel.y + 0.5) as usize * 320 + (pixel.x + 0.5) as usize;
        let mut near = [index - 320, index, index + 320].into_iter().flat_map(|i| i - 1..=i + 1);
        assert!(near.any(|i| picture.coverage[i] > 0.0), "{pixel}");
        if studio::score::sees(&scene, &camera, p, n) {
            seen[index] = true;
        }
    }
    let full = picture.coverage.iter().filter(|c| **c == 1.0).count();
    let hit = picture.coverage.iter().zip(&seen).filter(|(c, hit)| **c == 1.0 && **hit).count();
    assert!(full > 2000 && hit as f64 > 0.7 * full as f64, "{hit} of {full}");
}

/// A picture with lens distortion is the resampled picture without it.
#[test]
fn distortion_moves_pixels_and_nothing_else() {
    let scene = Subject::Figure.at(0.0);
    let (straight, bent) = (camera([0.0; 5]), camera(LENS));
    let (a, b) = (render(&scene, &straight), render(&scene, &bent));
    let (mut off, mut moved, mut count) = (0.0, 0.0, 0);
    for y in 20..220 {
        for x in 40..280 {
            let p = bent.distort_pixel(DVec2::new(f64::from(x), f64::from(y)));
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

/// The bytes are the same every time and on every machine.
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
    assert_eq!(first, 0x8f77_168e_7ae5_09e8, "{first:#018x}");
}
