//! Facts about contours that are known exactly: discs before a screen, with blur, noise and wrong mattes.

use super::*;
use crate::silhouette::Silhouette;
use alloc::vec;

const W: usize = 200;
const H: usize = 160;
const RADIUS: f32 = 45.3;

const SKIN: [f32; 3] = [190.0, 140.0, 115.0];
const GREEN: [f32; 3] = [40.0, 150.0, 70.0];
const BLACK: [f32; 3] = [14.0, 13.0, 15.0];

/// Signed distance to the disc, positive inside.
fn truth(x: f32, y: f32) -> f32 {
    RADIUS - libm::hypotf(x - 98.7, y - 81.4)
}

fn plane<T>(f: impl Fn(f32, f32) -> T) -> Vec<T> {
    (0..W * H).map(|i| f((i % W) as f32, (i / W) as f32)).collect()
}

/// A matte that is wrong by `error` pixels outwards.
fn matte(error: impl Fn(f32, f32) -> f32) -> Vec<u8> {
    plane(|x, y| if truth(x, y) + error(x, y) > 0.0 { 255 } else { 0 })
}

/// The disc of one colour before another, blurred like a lens does (σ = 0.8 pixel), with noise of σ = `noise` levels.
fn picture(object: [f32; 3], background: impl Fn(f32, f32) -> [f32; 3], noise: f32) -> Vec<u8> {
    let mut state = 7u32;
    let mut random = move || {
        let sum: u32 = (0..8)
            .map(|_| {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                state >> 24
            })
            .sum();
        // The sum of eight has a standard deviation of 209.
        (sum as f32 - 1020.0) / 209.0
    };
    let mut rgb = Vec::new();
    for i in 0..W * H {
        let (x, y) = ((i % W) as f32, (i / W) as f32);
        let share = 0.5 * libm::erfcf(-truth(x, y) / (0.8 * core::f32::consts::SQRT_2));
        let behind = background(x, y);
        for c in 0..3 {
            let value = object[c] * share + behind[c] * (1.0 - share) + noise * random();
            rgb.push((value + 0.5).clamp(0.0, 255.0) as u8);
        }
    }
    rgb
}

fn moved(rgb: &[u8], coverage: &mut [u8], known: impl Fn(usize) -> bool) -> Option<Uncertainty> {
    let scratch = &mut RefineScratch::default();
    refine(W, rgb, coverage, &known, &ContourParams::default(), scratch, Uncertainty::default())
        .map(|(uncertainty, _)| uncertainty)
}

struct Refined {
    /// Absolute errors of the contour at pixels next to the true one, in ascending order.
    errors: Vec<f32>,
    mean: f32,
    uncertainty: Uncertainty,
    coverage: Vec<u8>,
}

impl Refined {
    fn quantile(&self, q: f32) -> f32 {
        self.errors[((self.errors.len() - 1) as f32 * q) as usize]
    }
}

fn contour_errors(coverage: &[u8]) -> Vec<f32> {
    let silhouette = Silhouette::from_coverage(W as u32, H as u32, coverage, |_| true).unwrap();
    let at = |i: usize| ((i % W) as f32, (i / W) as f32);
    let error = |i: usize, d: i16| f32::from(d) / Silhouette::UNITS - truth(at(i).0, at(i).1);
    let near = |i: usize| truth(at(i).0, at(i).1).abs() < 0.7;
    silhouette.distances().iter().enumerate().filter(|&(i, _)| near(i)).map(|(i, &d)| error(i, d)).collect()
}

fn refined(rgb: &[u8], mut coverage: Vec<u8>) -> Refined {
    let uncertainty = moved(rgb, &mut coverage, |_| true).unwrap();
    let mut errors = contour_errors(&coverage);
    let mean = errors.iter().sum::<f32>() / errors.len() as f32;
    errors.iter_mut().for_each(|e| *e = e.abs());
    errors.sort_unstable_by(f32::total_cmp);
    Refined { errors, mean, uncertainty, coverage }
}

/// Largest standard deviation and smallest along the true contour.
fn sigmas(uncertainty: &Uncertainty) -> (f32, f32) {
    let mut range = (f32::INFINITY, 0.0f32);
    for k in 0..360 {
        let angle = k as f32 * core::f32::consts::PI / 180.0;
        let point = (98.7 + RADIUS * libm::cosf(angle), 81.4 + RADIUS * libm::sinf(angle));
        if let Some(sigma) = uncertainty.sigma(point.0, point.1) {
            range = (range.0.min(sigma), range.1.max(sigma));
        }
    }
    range
}

#[test]
fn wrong_mattes_are_moved_to_the_pictures_contour() {
    let wavy = |x: f32, y: f32| 2.0 * libm::sinf(x / 9.0) * libm::cosf(y / 11.0);
    let errors: [&dyn Fn(f32, f32) -> f32; 6] =
        [&|_, _| 1.0, &|_, _| -1.0, &|_, _| 4.0, &|_, _| -4.0, &wavy, &|x, _| if x > 130.0 { -6.0 } else { 0.0 }];
    for (k, error) in errors.iter().enumerate() {
        for (object, noise) in [(SKIN, 4.0), (SKIN, 10.0), (BLACK, 4.0)] {
            let found = refined(&picture(object, |_, _| GREEN, noise), matte(error));
            let (median, most) = (found.quantile(0.5), found.quantile(0.95));
            assert!(median < 0.2 && most < 0.5, "error {k}, {object:?} with noise {noise}: {median}, {most}");
            assert!(found.mean.abs() < 0.15, "error {k}, {object:?} with noise {noise}: bias {}", found.mean);
        }
    }
}

#[test]
fn a_contour_before_an_uneven_screen_is_found() {
    // Brightness varies by more than the colours differ in it.
    let lit = |x: f32, y: f32| GREEN.map(|v| v * (0.6 + 0.004 * x + 0.1 * libm::sinf(y / 7.0)));
    let found = refined(&picture(SKIN, lit, 4.0), matte(|_, _| -2.0));
    assert!(found.quantile(0.5) < 0.2 && found.quantile(0.95) < 0.6, "{:?}", found.quantile(0.95));
}

#[test]
fn exact_mattes_stay() {
    let soft = plane(|x, y| ((truth(x, y) + 0.5).clamp(0.0, 1.0) * 255.0 + 0.5) as u8);
    for given in [soft, matte(|_, _| 0.0)] {
        let mut before: Vec<f32> = contour_errors(&given).into_iter().map(f32::abs).collect();
        before.sort_unstable_by(f32::total_cmp);
        let found = refined(&picture(SKIN, |_, _| GREEN, 6.0), given);
        let allowed = before[before.len() / 2] + 0.05;
        assert!(found.quantile(0.5) < allowed, "{} instead of {allowed}", found.quantile(0.5));
        assert!(found.mean.abs() < 0.05, "{}", found.mean);
    }
}

#[test]
fn alike_colours_keep_the_matte_and_are_marked_uncertain() {
    let wrong = |x: f32, y: f32| libm::sinf(x / 13.0) + libm::sinf(y / 17.0);
    let given = matte(wrong);
    let found = refined(&picture(BLACK, |_, _| BLACK, 4.0), given.clone());
    let silhouette = |coverage: &[u8]| Silhouette::from_coverage(W as u32, H as u32, coverage, |_| true).unwrap();
    let (old, new) = (silhouette(&given), silhouette(&found.coverage));
    for (&a, &b) in old.distances().iter().zip(new.distances()) {
        let moved = f32::from(b - a).abs() / Silhouette::UNITS;
        assert!(f32::from(a).abs() > 64.0 || moved < 0.5, "moved by {moved}");
    }
    let (least, most) = sigmas(&found.uncertainty);
    assert!(least > 0.3 && most > 0.5, "{least} to {most}");
    let (_, most) = sigmas(&refined(&picture(SKIN, |_, _| GREEN, 4.0), given).uncertainty);
    assert!(most < 0.4, "{most}");
}

#[test]
fn where_the_picture_says_nothing_the_mattes_bias_is_taken_off() {
    // The right part is before a wall of the object's colour; the whole matte is 3 pixels too wide.
    let wall = |x: f32, _: f32| if x > 125.0 { BLACK } else { GREEN };
    let found = refined(&picture(BLACK, wall, 3.0), matte(|_, _| 3.0));
    let silhouette = Silhouette::from_coverage(W as u32, H as u32, &found.coverage, |_| true).unwrap();
    let d = silhouette.sample(98.7 + RADIUS, 81.4).unwrap();
    assert!(d.abs() < 0.7, "the contour is off by {d}");
    let certain = found.uncertainty.sigma(98.7 - RADIUS, 81.4).unwrap();
    let uncertain = found.uncertainty.sigma(98.7 + RADIUS, 81.4).unwrap();
    assert!(uncertain > certain, "{certain} and {uncertain}");
}

#[test]
fn holes_bays_and_specks_are_settled_by_colour() {
    let near = |x: f32, y: f32, at: (f32, f32)| libm::hypotf(x - at.0, y - at.1) < 7.0;
    // The last hole is real: green can be seen through it.
    let (hole, bay, speck, window) = ((90.0, 70.0), (98.7, 81.4 + RADIUS - 4.0), (170.0, 30.0), (110.0, 95.0));
    let mut given = matte(|_, _| 0.0);
    let mut rgb = picture(SKIN, |_, _| GREEN, 4.0);
    for i in 0..W * H {
        let (x, y) = ((i % W) as f32, (i / W) as f32);
        if near(x, y, hole) || near(x, y, bay) || near(x, y, window) {
            given[i] = 0;
        }
        if near(x, y, speck) {
            given[i] = 255;
        }
        if near(x, y, window) {
            (0..3).for_each(|c| rgb[3 * i + c] = GREEN[c] as u8);
        }
    }
    let found = refined(&rgb, given);
    let at = |p: (f32, f32)| found.coverage[p.1 as usize * W + p.0 as usize];
    assert_eq!(at(hole), 255, "the hole is filled");
    assert_eq!(at((bay.0, bay.1)), 255, "the bay is filled");
    assert_eq!(at(speck), 0, "the speck is removed");
    assert_eq!(at(window), 0, "what is background through a gap stays so");
}

#[test]
fn an_object_cut_by_the_pictures_edge_stays_whole() {
    // Everything left of x = 60.4 is object, up to three edges.
    let side = |x: f32| 60.4 - x;
    let mut coverage = plane(|x, _| if side(x) > 1.0 { 255 } else { 0 });
    let rgb: Vec<u8> = plane(|x, _| {
        let share = (side(x) + 0.5).clamp(0.0, 1.0);
        core::array::from_fn::<u8, 3, _>(|c| (SKIN[c] * share + GREEN[c] * (1.0 - share)) as u8)
    })
    .concat();
    moved(&rgb, &mut coverage, |_| true).unwrap();
    for (i, &c) in coverage.iter().enumerate() {
        let d = side((i % W) as f32);
        assert!(d.abs() < 1.2 || (c > 127) == (d > 0.0), "pixel {i}: {c}");
        assert!(d < 2.0 || c == 255, "pixel {i}: {c}");
    }
}

#[test]
fn what_is_unknown_is_left_alone_and_nothing_gives_nothing() {
    let rgb = picture(SKIN, |_, _| GREEN, 4.0);
    let given = matte(|_, _| 2.0);
    let mut coverage = given.clone();
    let known = |i: usize| i % W > 80;
    assert!(moved(&rgb, &mut coverage, known).is_some());
    assert!((0..W * H).all(|i| known(i) || coverage[i] == given[i]));
    assert!((0..W * H).any(|i| coverage[i] != given[i]));
    let mut empty = vec![0; W * H];
    assert!(moved(&rgb, &mut empty, |_| true).is_none());
    // Nothing but object has no contour, and stays.
    let mut full = vec![255; W * H];
    moved(&rgb, &mut full, |_| true);
    assert!(full.iter().all(|&c| c == 255));
}

#[test]
fn a_matte_of_noise_is_left_alone() {
    let rgb = picture(BLACK, |_, _| BLACK, 4.0);
    let given = plane(|x, y| if (x as usize / 2 + y as usize / 2).is_multiple_of(2) { 255 } else { 0 });
    let mut coverage = given.clone();
    assert_eq!(moved(&rgb, &mut coverage, |_| true), None);
    assert_eq!(coverage, given);
}

/// How far a matte was off, and to which sides, is known after its contour has moved.
#[test]
fn how_far_a_contour_has_moved_is_measured() {
    let by = |error: &dyn Fn(f32, f32) -> f32| {
        let (scratch, params) = (&mut RefineScratch::default(), ContourParams::default());
        let rgb = picture(SKIN, |_, _| GREEN, 4.0);
        refine(W, &rgb, &mut matte(error), &|_| true, &params, scratch, Uncertainty::default()).expect("a contour").1
    };
    assert_eq!(by(&|_, _| 0.0), Moved { median: 0.0, far: [0.0; 2] });
    for wider in [-4.0, 4.0] {
        let Moved { median, far: [inwards, outwards] } = by(&|_, _| wider);
        assert!((median - wider).abs() < 0.3, "{wider}: {median}");
        assert_eq!([inwards, outwards], if wider > 0.0 { [1.0, 0.0] } else { [0.0, 1.0] });
    }
    // The disc's matte four pixels to the left: two thirds of the contour are more than two pixels off.
    let Moved { median, far } = by(&|x, _| -4.0 * (x - 98.7) / RADIUS);
    assert!(median.abs() < 0.6 && far.iter().all(|share| (0.25..0.4).contains(share)), "{median} {far:?}");
}
