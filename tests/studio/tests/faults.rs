//! Each fault has the described effect and no other.

use glam::DVec3;
use std::sync::LazyLock;
use studio::{Capture, Faults, Picture, Ring, Subject};

fn record(faults: Faults) -> Capture {
    let cameras = Ring { count: 4, ..Ring::default() }.sized(160, 120).cameras();
    Capture::still(Subject::Figure, &cameras, &faults)
}

static CLEAN: LazyLock<Capture> = LazyLock::new(|| record(Faults::default()));

fn differences(a: &Picture, b: &Picture) -> Vec<f64> {
    a.rgb.iter().zip(&b.rgb).map(|(a, b)| f64::from(*a) - f64::from(*b)).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn none_by_default() {
    assert_eq!(CLEAN.cameras, CLEAN.true_cameras);
    assert!(CLEAN.frames[0].masks.iter().all(Option::is_some));
}

#[test]
fn noise_has_its_standard_deviation() {
    let noisy = record(Faults { noise: 3.0, ..Faults::default() });
    assert_eq!(noisy.frames[0].masks, CLEAN.frames[0].masks);
    for (a, b) in noisy.frames[0].images.iter().zip(&CLEAN.frames[0].images) {
        let d = differences(a, b);
        let deviation = libm::sqrt(mean(&d.iter().map(|v| v * v).collect::<Vec<_>>()));
        assert!(mean(&d).abs() < 0.1 && (deviation - 3.0).abs() < 0.15, "{} ± {deviation}", mean(&d));
    }
    let frames =
        Capture::new(Subject::Sphere, &CLEAN.true_cameras, &[0.0; 2], &Faults { noise: 3.0, ..Faults::default() });
    assert_ne!(frames.frames[0].images, frames.frames[1].images);
}

#[test]
fn gains_scale_channels() {
    let faults = Faults { gain: 0.1, ..Faults::default() };
    let gained = record(faults.clone());
    let mut seen = Vec::new();
    for (i, (a, b)) in gained.frames[0].images.iter().zip(&CLEAN.frames[0].images).enumerate() {
        for (channel, gain) in faults.gains_of(i).into_iter().enumerate() {
            assert!((gain - 1.0).abs() < 0.16);
            let sum = |p: &Picture| p.rgb.iter().skip(channel).step_by(3).map(|v| f64::from(*v)).sum::<f64>();
            assert!((sum(a) / sum(b) - gain).abs() < 0.01);
            seen.push(gain);
        }
    }
    assert!(seen.iter().any(|g| *g < 0.98) && seen.iter().any(|g| *g > 1.02));
}

#[test]
fn blur_keeps_brightness_and_loses_detail() {
    let blurred = record(Faults { blur: 1.5, ..Faults::default() });
    let detail = |p: &Picture| p.rgb.windows(4).map(|w| f64::from(w[0].abs_diff(w[3]))).sum::<f64>();
    for (a, b) in blurred.frames[0].images.iter().zip(&CLEAN.frames[0].images) {
        assert!(mean(&differences(a, b)).abs() < 0.3);
        assert!(detail(a) < 0.7 * detail(b), "{} of {}", detail(a), detail(b));
    }
}

#[test]
fn calibration_is_off_by_its_pixels() {
    let off = record(Faults { calibration: 1.5, ..Faults::default() });
    assert_eq!(off.frames[0].images, CLEAN.frames[0].images);
    let point = DVec3::new(0.0, 0.0, 0.9);
    for (given, truth) in off.cameras.iter().zip(&off.true_cameras) {
        given.check().unwrap();
        assert!((given.centre() - truth.centre()).length() < 1e-9);
        let miss = (given.project(point).unwrap().0 - truth.project(point).unwrap().0).length();
        assert!((miss - 1.5).abs() < 0.03, "{miss}");
    }
}

#[test]
fn single_cameras_are_bumped() {
    let off = record(Faults { bumped: vec![(2, [3.0, -4.0])], ..Faults::default() });
    assert_eq!(off.frames[0].images, CLEAN.frames[0].images);
    let point = DVec3::new(0.0, 0.0, 0.9);
    for (i, (given, truth)) in off.cameras.iter().zip(&off.true_cameras).enumerate() {
        let miss = given.project(point).unwrap().0 - truth.project(point).unwrap().0;
        let expected = if i == 2 { glam::DVec2::new(3.0, -4.0) } else { glam::DVec2::ZERO };
        assert!((miss - expected).length() < 0.1, "camera {i}: {miss}");
    }
}

#[test]
fn cameras_are_exchanged_and_late() {
    let mut frame = CLEAN.frames[0].clone();
    frame.exchange(0, 3);
    frame.retake(1, &CLEAN.true_cameras[1], Subject::Figure, 0.4);
    let late = Capture::new(Subject::Figure, &CLEAN.true_cameras, &[0.4], &Faults::default());
    let expected = [&CLEAN.frames[0], &late.frames[0], &CLEAN.frames[0], &CLEAN.frames[0]];
    for (i, from) in [3, 1, 2, 0].into_iter().enumerate() {
        assert_eq!((&frame.images[i], &frame.masks[i]), (&expected[i].images[from], &expected[i].masks[from]));
    }
}

#[test]
fn clocks_show_other_instants() {
    let faults = Faults { clock: 0.3, ..Faults::default() };
    let late = record(faults.clone());
    for (i, camera) in CLEAN.true_cameras.iter().enumerate() {
        let then = Capture::new(Subject::Figure, &[*camera], &[faults.clock_of(i)], &Faults::default());
        assert_eq!(late.frames[0].images[i], then.frames[0].images[0]);
        assert_ne!(late.frames[0].images[i], CLEAN.frames[0].images[i]);
    }
}

#[test]
fn views_go_missing() {
    let some = record(Faults { unmasked: vec![1], missing: vec![2], ..Faults::default() });
    let frame = &some.frames[0];
    assert_eq!(frame.masks.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false, false, true]);
    assert_eq!(frame.images[1], CLEAN.frames[0].images[1]);
    assert!(frame.images[2].rgb.is_empty() && frame.images[2].as_ref().check().is_err());
}

/// Coarse masks contain the exact ones and are at most as much wider as requested.
#[test]
fn coarse_masks_are_too_wide() {
    let coarse = record(Faults { coarse_masks: 3, ..Faults::default() });
    let exact = record(Faults { binary_masks: true, ..Faults::default() });
    for (wide, tight) in coarse.frames[0].masks.iter().zip(&exact.frames[0].masks) {
        let (wide, tight) = (wide.as_ref().unwrap(), tight.as_ref().unwrap());
        let mut wider = 0;
        for (i, v) in wide.iter().enumerate() {
            assert!(*v == 0 || *v == 255);
            assert!(*v == 255 || tight[i] == 0);
            if *v == 255 && tight[i] == 0 {
                wider += 1;
                let (x, y) = (i as i32 % 160, i as i32 / 160);
                let near = (y - 3..=y + 3).flat_map(|v| (x - 3..=x + 3).map(move |u| (u, v)));
                assert!(
                    near.filter(|(u, v)| (0..160).contains(u) && (0..120).contains(v))
                        .any(|(u, v)| tight[(v * 160 + u) as usize] == 255)
                );
            }
        }
        assert!(wider > 100, "{wider}");
    }
}

#[test]
fn jpeg_loses_a_little() {
    let lossy = record(Faults { jpeg: Some(80), ..Faults::default() });
    for (a, b) in lossy.frames[0].images.iter().zip(&CLEAN.frames[0].images) {
        let d = mean(&differences(a, b).iter().map(|v| v.abs()).collect::<Vec<_>>());
        assert!(d > 0.1 && d < 6.0, "{d}");
    }
}
