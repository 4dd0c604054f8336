//! Faults of masks are as large as they claim. A ball's outline is known exactly.

use glam::DVec3;
use studio::{Capture, Faults, Ring, Spots, Subject, masks::clear_columns, render::Lens};

const WIDTH: usize = 320;
const HEIGHT: usize = 240;
/// Centre of the ball and its radius in metres.
const BALL: (DVec3, f64) = (DVec3::new(0.0, 0.0, 0.9), 0.45);

fn record(faults: &Faults) -> Capture {
    let cameras = Ring { count: 4, ..Ring::default() }.sized(WIDTH as u32, HEIGHT as u32).cameras();
    Capture::new(Subject::Sphere, &cameras, &[0.0, 0.0], faults)
}

/// The masks of all cameras and frames.
fn masks(capture: &Capture) -> impl Iterator<Item = &Vec<u8>> {
    capture.frames.iter().flat_map(|frame| frame.masks.iter().map(|mask| mask.as_ref().unwrap()))
}

/// Distances in pixels by which the masks' contours lie outside the ball's outline. Each list has the points of one contour
/// in the order of their angle.
fn errors(faults: &Faults) -> Vec<Vec<f64>> {
    let capture = record(faults);
    let cameras = capture.true_cameras.iter().cycle();
    masks(&capture)
        .zip(cameras)
        .map(|(mask, camera)| {
            let lens = Lens::new(camera);
            let (centre, radius) = BALL;
            let to = centre - lens.centre();
            let middle = camera.project(centre).unwrap().0;
            let outline = libm::asin(radius / to.length());
            let mut found = Vec::new();
            for i in 0..mask.len() {
                let (x, y) = (i % WIDTH, i / WIDTH);
                let neighbours = [(x + 1, y), (x, y + 1)].into_iter().filter(|n| n.0 < WIDTH && n.1 < HEIGHT);
                for (u, v) in neighbours {
                    let [a, b] = [mask[i], mask[v * WIDTH + u]].map(|v| f64::from(v) - 127.5);
                    if (a > 0.0) == (b > 0.0) {
                        continue;
                    }
                    let share = a / (a - b);
                    let (x, y) = (x as f64 + share * (u - x) as f64, y as f64 + share * (v - y) as f64);
                    let angle = libm::acos(lens.ray(x, y).dot(to.normalize()));
                    let around = libm::atan2(y - middle.y, x - middle.x);
                    found.push((around, (angle - outline) * camera.k[0][0]));
                }
            }
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            found.into_iter().map(|(_, error)| error).collect()
        })
        .collect()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    values.for_each(|v| (sum, count) = (sum + v, count + 1.0));
    sum / count
}

fn rms(values: &[f64]) -> f64 {
    libm::sqrt(mean(values.iter().map(|v| v * v)))
}

#[test]
fn exact_masks_have_exact_contours() {
    for contour in errors(&Faults::default()) {
        assert!(contour.len() > 250 && rms(&contour) < 0.1, "{} {}", contour.len(), rms(&contour));
    }
}

#[test]
fn wide_and_narrow_masks() {
    for wider_masks in [-2.0, -1.0, 1.0, 2.0] {
        for contour in errors(&Faults { wider_masks, ..Faults::default() }) {
            let error = mean(contour.iter().copied());
            assert!((error - wider_masks).abs() < 0.1, "{error} instead of {wider_masks}");
        }
    }
}

/// The errors are measured along the displaced contour, which is longer where the mask is wider.
#[test]
fn contours_are_off_by_their_pixels() {
    for (contour_error, binary_masks) in [(1.0, false), (1.0, true), (3.0, false)] {
        let masks = errors(&Faults { contour_error, binary_masks, ..Faults::default() });
        let shares: Vec<f64> = masks.iter().map(|contour| rms(contour) / contour_error).collect();
        assert!(
            shares.iter().all(|share| (share - 1.0).abs() < 0.08 * (1.0 + contour_error)),
            "{contour_error}: {shares:?}"
        );
        let all = mean(shares.iter().copied());
        assert!((all - 1.0).abs() < 0.05, "{contour_error}: {all}");
    }
}

/// Places 12 pixels apart share most of their error, places 40 pixels apart and other masks nearly nothing.
#[test]
fn errors_of_contours_are_smooth_and_differ_between_masks() {
    let masks = errors(&Faults { contour_error: 1.0, ..Faults::default() });
    // The points of every contour, one per pixel of its length.
    let length = core::f64::consts::TAU * 42.0;
    let even = |m: usize, i: f64| {
        let contour = &masks[m % masks.len()];
        contour[(i / length * contour.len() as f64) as usize % contour.len()]
    };
    let correlation = |other: usize, apart: f64| {
        mean(
            (0..masks.len())
                .flat_map(|m| (0..length as u32).map(move |i| (m, f64::from(i))))
                .map(|(m, i)| even(m, i) * even(m + other, i + apart)),
        )
    };
    let (near, far) = (correlation(0, 12.0), correlation(0, 40.0));
    println!("{near} after 12 pixels, {far} after 40");
    assert!((near - 0.78).abs() < 0.08, "{near}");
    assert!(far.abs() < 0.3, "{far}");
    // Four cameras in two frames.
    for other in 1..8 {
        assert!(correlation(other, 0.0).abs() < 0.35, "{other}: {}", correlation(other, 0.0));
    }
}

#[test]
fn holes_and_specks_have_their_size() {
    let spots = Spots { count: 30, diameter: 8.0 };
    let clean = record(&Faults::default());
    let holes = record(&Faults { holes: spots, ..Faults::default() });
    let specks = record(&Faults { specks: spots, ..Faults::default() });
    // A disc of diameter 8 has 49 pixels. Discs overlap, and holes may lie at the contour.
    let sizes = 15 * 49..=30 * 49;
    for ((clean, holes), specks) in masks(&clean).zip(masks(&holes)).zip(masks(&specks)) {
        let changed = |mask: &[u8]| clean.iter().zip(mask).filter(|(a, b)| a != b).count();
        assert!(sizes.contains(&changed(holes)) && sizes.contains(&changed(specks)));
        assert!(clean.iter().zip(holes).all(|(a, b)| a == b || *b == 0));
        assert!(clean.iter().zip(specks).all(|(a, b)| a == b || *b == 255));
        // Specks do not touch the subject: three pixels around one are background.
        for i in (0..clean.len()).filter(|&i| specks[i] != clean[i]) {
            let (x, y) = (i % WIDTH, i / WIDTH);
            let near = |v: usize, size: usize| v.saturating_sub(3)..(v + 4).min(size);
            assert!(near(y, HEIGHT).all(|v| near(x, WIDTH).all(|u| clean[v * WIDTH + u] == 0)));
        }
    }
    let different = masks(&holes).zip(masks(&holes).skip(1)).all(|(a, b)| a != b);
    assert!(different, "every mask has holes of its own");
}

#[test]
fn a_quarter_of_the_subject_is_cleared() {
    let clean = record(&Faults::default());
    for mask in masks(&clean) {
        let mut cut = mask.clone();
        clear_columns(&mut cut, WIDTH as u32, 0.0..0.25);
        let columns = |mask: &[u8]| {
            let on: Vec<usize> = (0..mask.len()).filter(|&i| mask[i] > 127).map(|i| i % WIDTH).collect();
            (*on.iter().min().unwrap(), *on.iter().max().unwrap())
        };
        let ((low, high), (l, h)) = (columns(mask), columns(&cut));
        assert_eq!((l, h), (low + (high - low + 1) / 4, high));
        assert!((0..mask.len()).all(|i| if (low..l).contains(&(i % WIDTH)) { cut[i] == 0 } else { cut[i] == mask[i] }));
    }
}

/// Faults that are given to an exact mask later are those that it would have been recorded with.
#[test]
fn masks_are_spoilt_later_as_well() {
    let faults =
        Faults { wider_masks: 1.0, holes: Spots { count: 2, diameter: 5.0 }, unmasked: vec![1], ..Faults::default() };
    let (mut later, recorded) = (record(&Faults::default()), record(&faults));
    for (i, frame) in later.frames.iter_mut().enumerate() {
        frame.spoil_masks(&faults, i);
        assert_eq!(frame.masks[1], None);
        for (a, b) in frame.masks.iter().flatten().zip(recorded.frames[i].masks.iter().flatten()) {
            assert!(a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1));
        }
    }
}
