//! Captures with faults give sound results with bounded errors.

use facts::{
    Errors, Shot,
    topology::{assert_sound, components},
};
use pcmvs_core::{Camera, Lens, Params, Preset};
use std::sync::LazyLock;
use studio::{Faults, Ring, Subject};

static RING: LazyLock<Ring> = LazyLock::new(|| Ring { count: 12, ..Ring::default() }.sized(320, 240));

/// Errors of the default preset. The mesh must be sound and have as many components as there are bodies.
fn errors(shot: &Shot, bodies: usize, what: &str) -> Errors {
    let result = shot.reconstruct(&Params::preset(Preset::Default)).expect("faults are no errors");
    assert_sound(&result.mesh, what);
    assert_eq!(components(&result.mesh).len(), bodies, "{what}");
    Errors::new(shot, &result.mesh)
}

fn torus(faults: &Faults) -> Shot {
    Shot::new(Subject::Torus, &RING.cameras(), faults)
}

#[test]
fn no_fault() {
    errors(&torus(&Faults::default()), 1, "no fault").assert_within(0.9, 0.7, "no fault");
}

/// The lens is undone, whatever its model.
#[test]
fn lenses() {
    for lens in [
        Lens::OpenCv([0.52, -2.6, 4e-4, -2e-4, 1.45, 0.39, -2.4, 1.38, 0.0, 0.0, 0.0, 0.0]),
        Lens::OpenCv([-0.1, 0.03, 0.002, 0.001, 0.0, 0.0, 0.0, 0.0, 0.02, -0.01, -0.02, 0.01]),
        Lens::Fisheye([-0.03, 0.02, -0.03, 0.017]),
    ] {
        let cameras: Vec<Camera> = RING.cameras().into_iter().map(|camera| Camera { lens, ..camera }).collect();
        let what = format!("{lens:?}");
        errors(&Shot::new(Subject::Torus, &cameras, &Faults::default()), 1, &what).assert_within(0.9, 0.7, &what);
    }
}

/// Masks that are one or two pixels too wide make the hull too wide by no more than that.
#[test]
fn wide_masks() {
    let faults = Faults { coarse_masks: 2, ..Faults::default() };
    errors(&torus(&faults), 1, "wide masks").assert_within(0.9, 2.0, "wide masks");
}

#[test]
fn a_view_without_mask() {
    let faults = Faults { unmasked: vec![3], ..Faults::default() };
    errors(&torus(&faults), 1, "one mask missing").assert_within(0.9, 0.9, "one mask missing");
}

#[test]
fn noise_gains_and_blur() {
    let noise = Faults { noise: 4.0, ..Faults::default() };
    errors(&torus(&noise), 1, "noise").assert_within(0.9, 0.8, "noise");
    let gain = Faults { gain: 0.2, ..Faults::default() };
    errors(&torus(&gain), 1, "gains").assert_within(0.9, 0.8, "gains");
    let blur = Faults { blur: 0.8, jpeg: Some(85), ..Faults::default() };
    errors(&torus(&blur), 1, "blur").assert_within(0.9, 0.8, "blur");
}

/// Interpolating a mosaic's colours blurs them and smooths their noise, so that it looks like texture.
#[test]
fn noise_of_a_mosaic() {
    let faults = Faults { noise: 4.0, mosaic: true, ..Faults::default() };
    errors(&torus(&faults), 1, "mosaic").assert_within(0.9, 0.52, "mosaic");
}

/// Contours are off by a pixel in long stretches, as keyers leave them. The pictures show where they are.
#[test]
fn smooth_errors_of_contours() {
    let faults = Faults { contour_error: 1.0, ..Faults::default() };
    errors(&torus(&faults), 1, "contours").assert_within(0.9, 0.35, "contours");
}

/// A calibration error of half a pixel costs about as much.
#[test]
fn calibration_errors() {
    let faults = Faults { calibration: 0.5, ..Faults::default() };
    errors(&torus(&faults), 1, "calibration").assert_within(0.9, 1.2, "calibration");
}

/// One camera is 50 ms late while the figure dances.
#[test]
fn a_view_out_of_step() {
    let mut shot = Shot::new(Subject::Figure, &RING.cameras(), &Faults::default());
    shot.frame.retake(5, &shot.cameras[5], Subject::Figure, 0.05);
    errors(&shot, 1, "out of step").assert_within(0.9, 2.0, "out of step");
}

/// Separate bodies stay separate.
#[test]
fn two_bodies() {
    let shot = Shot::new(Subject::TwoBodies, &RING.cameras(), &Faults { noise: 2.0, ..Faults::default() });
    errors(&shot, 2, "two bodies").assert_within(0.9, 1.0, "two bodies");
}

/// Every preset gives a sound mesh, even of thin bodies.
#[test]
fn every_preset_is_sound() {
    for subject in [Subject::Plate, Subject::Figure] {
        let shot = Shot::new(subject, &RING.cameras(), &Faults::default());
        for preset in [Preset::Default, Preset::Paper, Preset::Hull, Preset::Preview] {
            let what = format!("{subject:?} {preset:?}");
            let result = shot.reconstruct(&Params::preset(preset)).expect(&what);
            assert_sound(&result.mesh, &what);
            assert_eq!(components(&result.mesh).len(), 1, "{what}");
        }
    }
}
