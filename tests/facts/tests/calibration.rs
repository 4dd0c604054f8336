//! The calibration is checked and refined by what the cameras record.

use facts::{Shot, errors::quantile, threads};
use glam::DVec3;
use pcmvs_core::{
    Camera, Executor, Params, Preset, Serial, Silent, View, Warning,
    calibration::{Calibration, CalibrationParams, Finding, Verdict, calibrate},
    silhouette::ContourFault,
};
use std::sync::LazyLock;
use studio::{Capture, Faults, Ring, Subject, score};

const CAMERAS: u32 = 12;

fn cameras() -> Vec<Camera> {
    Ring { count: CAMERAS, ..Ring::default() }.sized(512, 384).cameras()
}

fn record(faults: &Faults) -> Shot {
    Shot::new(Subject::Figure, &cameras(), faults)
}

fn calibrated_by(shots: &[&Shot], executor: &dyn Executor) -> Calibration {
    let rig = shots[0].rig();
    let views: Vec<Vec<View>> = shots
        .iter()
        .map(|shot| {
            let mut views = shot.views(&rig);
            views.sort_by_key(|view| view.index);
            views
        })
        .collect();
    let views: Vec<&[View]> = views.iter().map(Vec::as_slice).collect();
    calibrate(&rig, &views, &CalibrationParams::default(), executor, &Silent).expect("the scene is sound")
}

fn calibrated(shot: &Shot) -> Calibration {
    calibrated_by(&[shot], &Serial)
}

/// Points of the true surface that two cameras see.
fn points(shot: &Shot) -> Vec<DVec3> {
    score::seen(shot.truth(), &cameras(), 2, 300).into_iter().map(|(point, _)| point).collect()
}

/// Distances in pixels of true points from their epipolar lines, ascending, over all pairs of neighbouring cameras.
fn epipolar_errors(found: &[Camera], points: &[DVec3]) -> Vec<f64> {
    let truth = cameras();
    let ray = |camera: &Camera, point: DVec3, of: &Camera| {
        let (pixel, _) = of.project(point).expect("cameras look at the subject");
        let r = glam::DMat3::from_cols_array_2d(&camera.r);
        r * camera.normalise(pixel).extend(1.0)
    };
    let mut errors = Vec::new();
    for i in 0..truth.len() {
        let j = (i + 1) % truth.len();
        let (a, b) = (&found[i], &found[j]);
        for &point in points {
            let normal = (b.centre() - a.centre()).cross(ray(a, point, &truth[i])).normalize();
            errors.push(ray(b, point, &truth[j]).dot(normal).abs() * b.k[0][0]);
        }
    }
    errors.sort_by(f64::total_cmp);
    errors
}

static CLEAN: LazyLock<Shot> = LazyLock::new(|| record(&Faults { noise: 2.0, gain: 0.05, ..Faults::default() }));

fn bumped(by: [f64; 2]) -> Shot {
    record(&Faults { bumped: vec![(4, by)], noise: 2.0, ..Faults::default() })
}

#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn wrong_directions_of_all_cameras_are_corrected_to_a_tenth_of_a_pixel() {
    for pixels in [1.0, 3.0] {
        let shot = record(&Faults { calibration: pixels, noise: 2.0, gain: 0.05, ..Faults::default() });
        let (found, points) = (calibrated(&shot), points(&shot));
        assert_eq!(found.verdict, Verdict::Improved);
        assert!(quantile(&epipolar_errors(&shot.cameras, &points), 0.5) > 0.5 * pixels);
        let errors = epipolar_errors(&found.cameras, &points);
        let [middle, most] = [0.5, 0.95].map(|share| quantile(&errors, share));
        assert!(middle < 0.05 && most < 0.15, "{pixels} px: {middle} {most}");
        assert!(found.findings.iter().any(|finding| matches!(finding, Finding::CalibrationInconsistent { .. })));
    }
}

#[test]
fn a_good_calibration_is_kept() {
    let found = calibrated(&CLEAN);
    assert_eq!(found.verdict, Verdict::Kept, "{:?}", found.held_out);
    assert_eq!(found.cameras, CLEAN.cameras);
    assert_eq!(found.findings, []);
}

/// Stereo finds depths whatever the calibration is. A frame tells by itself that they cannot be trusted.
#[test]
fn a_frame_measures_how_well_its_calibration_fits() {
    let off = record(&Faults { calibration: 1.5, noise: 2.0, gain: 0.05, ..Faults::default() });
    let params = Params::preset(Preset::Default);
    for (shot, is_off) in [(&*CLEAN, false), (&off, true)] {
        let made = shot.reconstruct(&params).expect("the scene is sound");
        let inconsistent = made.warnings.iter().find_map(|warning| match warning {
            Warning::CalibrationInconsistent { pixels } => Some(f64::from(*pixels)),
            _ => None,
        });
        let truth = quantile(&epipolar_errors(&shot.cameras, &points(shot)), 0.5);
        assert_eq!(inconsistent.is_some(), is_off, "{:?}", made.warnings);
        assert!(
            inconsistent.is_none_or(|pixels| (0.6..1.7).contains(&(pixels / truth))),
            "{inconsistent:?} of {truth} px"
        );
        let measured: Vec<f32> = made.diagnostics.iter().filter_map(|found| found.epipolar_px).collect();
        assert!(measured.len() >= 10, "{measured:?}");
        assert!(is_off || measured.iter().all(|&pixels| pixels < 0.3), "{measured:?}");
    }
}

#[test]
fn a_bumped_camera_is_named_and_corrected() {
    for by in [[2.0, 0.0], [-7.0, 7.0], [0.0, 25.0]] {
        let shot = bumped(by);
        let found = calibrated(&shot);
        let pixels = libm::hypot(by[0], by[1]);
        assert!(
            matches!(found.findings[..], [Finding::CameraBumped { camera: 4, pixels: p, or_lens: false }] if (p / pixels - 1.0).abs() < 0.1),
            "{by:?}: {:?}",
            found.findings
        );
        let errors = epipolar_errors(&found.cameras, &points(&shot));
        assert!(quantile(&errors, 0.95) < 0.1, "{by:?}: {}", quantile(&errors, 0.95));
    }
}

/// Its picture is larger than its calibration says, as that of a camera that went nearer. Where matches do not tell the two apart,
/// neither is called certain.
#[test]
fn a_wrong_focal_length_is_not_called_a_movement() {
    let mut shot = CLEAN.clone();
    (0..2).for_each(|i| shot.cameras[4].k[i][i] *= 1.04);
    let findings = calibrated(&shot).findings;
    let is_named = match findings[..] {
        [Finding::FocalLengthWrong { camera: Some(4), factor }] => (factor - 1.04).abs() < 0.01,
        [Finding::CameraBumped { camera: 4, or_lens, .. }] => or_lens,
        _ => false,
    };
    assert!(is_named, "{findings:?}");
}

#[test]
fn focal_lengths_that_are_all_wrong_are_named() {
    let mut shot = CLEAN.clone();
    shot.cameras.iter_mut().for_each(|camera| (0..2).for_each(|i| camera.k[i][i] *= 1.05));
    let findings = calibrated(&shot).findings;
    let [Finding::FocalLengthWrong { camera: None, factor }] = findings[..] else { panic!("{findings:?}") };
    // The given focal lengths count for something, too.
    assert!((1.03..1.06).contains(&factor), "{factor}");
}

#[test]
fn a_mask_without_half_of_the_object_is_named() {
    let mut shot = CLEAN.clone();
    let mask = shot.frame.masks[4].as_mut().expect("every camera has one");
    let first = mask.iter().position(|&v| v > 0).expect("it shows the object");
    let last = mask.iter().rposition(|&v| v > 0).expect("it shows the object");
    mask[..(first + last) / 2].fill(0);
    let findings = calibrated(&shot).findings;
    assert_eq!(findings, [Finding::SilhouetteSetAside { camera: 4, frames: 1, of: 1 }]);
}

/// Masks that are all too wide blame no camera.
#[test]
fn masks_that_are_all_at_fault_blame_no_camera() {
    let findings = calibrated(&record(&Faults { wider_masks: 10.0, ..Faults::default() })).findings;
    let [Finding::Contour(ContourFault::BesideEdges { pixels })] = findings[..] else { panic!("{findings:?}") };
    assert!((8.0..12.0).contains(&pixels), "{pixels}");
}

/// The other cameras, and with them the world, stay where they are.
#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn the_world_stays_in_place() {
    let shot = bumped([-7.0, 7.0]);
    let found = calibrated(&shot);
    let footprint = shot.footprint(DVec3::new(0.0, 0.0, 0.9));
    for (i, (found, given)) in found.cameras.iter().zip(&shot.cameras).enumerate() {
        let moved = (found.centre() - given.centre()).length() / footprint;
        assert!(moved < 0.3, "camera {i}: the centre moved by {moved} footprints");
        let turned = found.direction().cross(given.direction()).length() * given.k[0][0];
        assert!(i == 4 || turned < 0.2, "camera {i}: turned by {turned} px");
    }
}

#[test]
fn exchanged_pictures_are_named() {
    let mut shot = record(&Faults::default());
    shot.frame.exchange(2, 7);
    let found = calibrated(&shot);
    assert!(found.findings.contains(&Finding::CamerasSwapped { first: 2, second: 7 }), "{:?}", found.findings);
}

#[test]
fn a_picture_of_another_instant_is_named_and_its_camera_does_not_move() {
    let mut shot = record(&Faults::default());
    shot.frame.retake(3, &cameras()[3], Subject::Figure, 0.6);
    let found = calibrated(&shot);
    assert!(
        matches!(found.findings[..], [Finding::CameraContradicts { camera: 3, .. }]),
        "{:?} {:?}",
        found.findings,
        found.reports[3]
    );
    assert_eq!(found.cameras[3], shot.cameras[3]);
}

/// More frames show the object in more places of the pictures. That makes the largest errors smaller, at places that single
/// frames leave empty.
#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn frames_of_a_take_are_used_together() {
    let faults = Faults { calibration: 1.0, noise: 6.0, ..Faults::default() };
    let capture = Capture::new(Subject::Figure, &cameras(), &[0.0, 0.4, 0.8], &faults);
    let shot = |frame: usize| Shot { cameras: capture.cameras.clone(), frame: capture.frames[frame].clone() };
    let shots = [0, 1, 2].map(shot);
    let points = points(&shots[0]);
    let error = |shots: &[&Shot]| {
        let found = calibrated_by(shots, &Serial);
        quantile(&epipolar_errors(&found.cameras, &points), 0.95)
    };
    let single = [0, 1, 2].map(|i| error(&[&shots[i]]));
    let (mean, all) = (single.iter().sum::<f64>() / 3.0, error(&shots.each_ref()));
    assert!(all < 0.8 * mean, "single frames {single:?}, all {all}");
}

#[test]
fn neither_threads_nor_the_order_of_the_cameras_change_the_result() {
    let shot = bumped([-7.0, 7.0]);
    let found = calibrated(&shot);
    assert_eq!(calibrated_by(&[&shot], &threads(3)), found);
    let order = [4, 0, 7, 2, 9, 5, 1, 8, 6, 3, 11, 10];
    let permuted = calibrated(&shot.of_cameras(&order));
    for (i, &camera) in order.iter().enumerate() {
        assert_eq!(permuted.cameras[i], found.cameras[camera]);
        assert_eq!(permuted.reports[i], found.reports[camera]);
    }
}
