//! Views that contradict the others are found, named and not believed: the hull is the one that the other views make.

use facts::{
    Shot,
    topology::{assert_sound, components},
};
use pcmvs_core::{Frame, Memory, Mesh, Params, Preset, Serial, Silent, Warning};
use std::sync::LazyLock;
use studio::{Faults, Ring, Spots, Subject, dome, masks::clear_columns};

const CAMERAS: u32 = 16;
/// The camera at fault.
const ONE: usize = 5;

static RING: LazyLock<Ring> = LazyLock::new(|| Ring { count: CAMERAS, ..Ring::default() }.sized(480, 360));

static FIGURE: LazyLock<Shot> = LazyLock::new(|| figure_with(&Faults::default()));

fn figure_with(faults: &Faults) -> Shot {
    Shot::new(Subject::Figure, &RING.cameras(), faults)
}

/// The mesh of preset `hull`, and the warnings.
fn hull(shot: &Shot) -> (Mesh, Vec<Warning>) {
    hull_with(shot, Params::preset(Preset::Hull))
}

fn hull_with(shot: &Shot, params: Params) -> (Mesh, Vec<Warning>) {
    let rig = shot.rig();
    let mut frame = Frame::new(&rig, params, Memory::default());
    frame.run_all(&shot.inputs(), &Serial, &Silent).expect("faults are no errors");
    assert_sound(frame.mesh(), "hull");
    (frame.mesh().clone(), frame.warnings())
}

/// Volume of a closed mesh in cubic metres.
fn volume(mesh: &Mesh) -> f64 {
    components(mesh).iter().map(|component| component.volume).sum()
}

/// Fails unless the hull is that of all other cameras.
fn assert_hull_of_others(shot: &Shot, mesh: &Mesh, at_fault: &[usize], what: &str) {
    let others: Vec<usize> = (0..shot.cameras.len()).filter(|i| !at_fault.contains(i)).collect();
    let expected = volume(&hull(&shot.of_cameras(&others)).0);
    let found = volume(mesh);
    assert!((found / expected - 1.0).abs() < 0.002, "{what}: {found} m³ instead of {expected}");
}

/// Cameras about which there are warnings with a code.
fn named(warnings: &[Warning], code: &str) -> Vec<usize> {
    warnings.iter().filter(|w| w.code() == code).filter_map(|w| Some(w.camera()? as usize)).collect()
}

/// Turns a camera so that its picture moves by some pixels to the right and down.
fn bump(shot: &mut Shot, camera: usize, pixels: f64) {
    let shift = pixels * core::f64::consts::FRAC_1_SQRT_2;
    let faults = Faults { bumped: vec![(camera, [shift, shift])], ..Faults::default() };
    shot.cameras[camera] = faults.calibrated(&shot.cameras[camera], camera);
}

/// Noise, coarse masks and small errors of the calibration, which all cameras of an ordinary capture have, are no
/// contradiction.
#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn nobody_is_at_fault_in_an_ordinary_capture() {
    let ordinary = [
        Faults::default(),
        Faults { noise: 4.0, gain: 0.2, blur: 0.8, ..Faults::default() },
        Faults { coarse_masks: 2, ..Faults::default() },
        Faults { calibration: 0.5, ..Faults::default() },
    ];
    for faults in &ordinary {
        assert_eq!(hull(&figure_with(faults)).1, [], "{faults:?}");
    }
    let few = FIGURE.of_cameras(&[0, 3, 6, 8, 11, 14]);
    assert_eq!(hull(&few).1, [], "six cameras");
}

#[test]
fn a_mask_without_a_limb_carves_nothing() {
    let mut shot = FIGURE.clone();
    let mask = shot.frame.masks[ONE].as_mut().expect("the camera has a mask");
    clear_columns(mask, RING.width, 0.0..0.25);
    let (mesh, warnings) = hull(&shot);
    assert_eq!(named(&warnings, "silhouette-set-aside"), [ONE], "{warnings:?}");
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert_hull_of_others(&shot, &mesh, &[ONE], "a limb is missing");
}

#[test]
fn a_camera_that_was_moved_is_left_out() {
    for pixels in [6.0, 12.0, 24.0] {
        let mut shot = FIGURE.clone();
        bump(&mut shot, ONE, pixels);
        let (mesh, warnings) = hull(&shot);
        assert_eq!(named(&warnings, "camera-contradicts"), [ONE], "{pixels}: {warnings:?}");
        assert_eq!(warnings.len(), 1, "{pixels}: {warnings:?}");
        assert_hull_of_others(&shot, &mesh, &[ONE], "a camera was moved");
    }
}

/// Six of sixteen cameras were moved. All other views agree without them, so that it is known which ones.
#[test]
fn more_than_a_quarter_of_the_cameras_are_left_out_if_the_rest_agree() {
    let moved = [1, 3, 5, 8, 10, 13];
    let mut shot = FIGURE.clone();
    moved.iter().for_each(|&camera| bump(&mut shot, camera, 24.0));
    let (mesh, warnings) = hull(&shot);
    assert_eq!(named(&warnings, "camera-contradicts"), moved, "{warnings:?}");
    assert_eq!(warnings.len(), moved.len(), "{warnings:?}");
    assert_hull_of_others(&shot, &mesh, &moved, "six cameras were moved");
}

/// Half of the cameras are late. Nobody knows which half, and the report says so.
#[test]
fn two_halves_that_contradict_each_other_are_named_as_a_whole() {
    let mut shot = FIGURE.clone();
    (0..16).step_by(2).for_each(|camera| shot.frame.retake(camera, &RING.cameras()[camera], Subject::Figure, 0.5));
    let (_, warnings) = hull(&shot);
    let whole = warnings.iter().any(|warning| matches!(warning, Warning::SilhouettesContradict { .. }));
    assert!(whole, "{warnings:?}");
}

/// A camera that was moved by less than what others would lack is recognised by its own contour.
#[test]
fn a_camera_that_was_moved_a_little_is_left_out() {
    for pixels in [1.5, 2.0, 3.0] {
        let mut shot = FIGURE.clone();
        bump(&mut shot, ONE, pixels);
        let (mesh, warnings) = hull(&shot);
        assert_eq!(named(&warnings, "camera-contradicts"), [ONE], "{pixels} pixels: {warnings:?}");
        assert_eq!(warnings.len(), 1, "{pixels} pixels: {warnings:?}");
        assert_hull_of_others(&shot, &mesh, &[ONE], "a camera was moved a little");
    }
}

/// Of eight cameras none can be spared for a small error. The camera is named.
#[test]
fn of_few_cameras_one_that_was_moved_a_little_is_used_and_named() {
    let ring = Ring { count: 8, ..Ring::default() }.sized(480, 360);
    let mut shot = Shot::new(Subject::Figure, &ring.cameras(), &Faults::default());
    bump(&mut shot, ONE, 2.0);
    let (_, warnings) = hull(&shot);
    assert_eq!(named(&warnings, "silhouette-disagrees"), [ONE], "{warnings:?}");
}

#[test]
fn two_cameras_that_were_exchanged_are_named_and_left_out() {
    for [a, b] in [[ONE, ONE + 1], [0, 8], [3, 6], [10, 15]] {
        let mut shot = FIGURE.clone();
        shot.frame.exchange(a, b);
        let (mesh, warnings) = hull(&shot);
        assert_eq!(named(&warnings, "cameras-swapped"), [a, b], "{warnings:?}");
        assert_eq!(warnings.len(), 2, "{warnings:?}");
        assert_hull_of_others(&shot, &mesh, &[a, b], "two cameras were exchanged");
    }
}

#[test]
fn a_camera_out_of_step_is_left_out() {
    let mut shot = FIGURE.clone();
    shot.frame.retake(ONE, &shot.cameras[ONE], Subject::Figure, 0.5);
    let (mesh, warnings) = hull(&shot);
    assert_eq!(named(&warnings, "camera-contradicts"), [ONE], "{warnings:?}");
    assert_hull_of_others(&shot, &mesh, &[ONE], "a camera is late");
}

/// Holes in masks are filled, because they have the object's colours and all other views agree.
#[test]
fn holes_in_every_mask_are_filled() {
    let mut shot = FIGURE.clone();
    let whole = volume(&hull(&shot).0);
    shot.frame.spoil_masks(&Faults { holes: Spots { count: 4, diameter: 8.0 }, ..Faults::default() }, 0);
    let mut as_given = Params::preset(Preset::Hull);
    (as_given.agreement, as_given.contour) = (None, None);
    let carved = volume(&hull_with(&shot, as_given).0);
    assert!(carved < 0.8 * whole, "the holes take away only {carved} of {whole} m³");
    let found = volume(&hull(&shot).0);
    assert!((found / whole - 1.0).abs() < 0.01, "{found} m³ instead of {whole}");
}

/// Between cameras that face each other, the cones of their silhouettes overlap all the way. That is no person.
#[test]
fn four_cameras_make_one_body() {
    let shot = FIGURE.of_cameras(&[0, 4, 8, 12]);
    let (mesh, _) = hull(&shot);
    assert_eq!(components(&mesh).len(), 1);
    let (low, high) = mesh
        .positions
        .iter()
        .fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    assert!((high - low).max_element() < 2.2, "{low} to {high}");
}

/// Cameras that see the upper half and cameras that see the lower half make a whole person, although no place is seen by
/// all of them.
#[test]
fn views_of_a_part_count_for_what_they_see() {
    let upper = Ring { count: 12, ..*RING }.aimed(1.35, 0.32);
    let lower = Ring { count: 6, seed: 2, ..*RING }.aimed(0.45, 0.32);
    let cameras = dome(&[upper, lower]);
    let shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
    let (mesh, warnings) = hull(&shot);
    assert_eq!(warnings, []);
    assert_eq!(components(&mesh).len(), 1);
    let whole = hull(&FIGURE).0;
    let height = |mesh: &Mesh, shot: &Shot| {
        let z = mesh.positions.iter().map(|p| f64::from(p.z) + shot.rig().origin().z);
        z.fold((f64::MAX, f64::MIN), |(low, high), z| (low.min(z), high.max(z)))
    };
    let ((low, high), (l, h)) = (height(&mesh, &shot), height(&whole, &FIGURE));
    assert!((low - l).abs() < 0.02 && (high - h).abs() < 0.02, "{low} to {high} m instead of {l} to {h}");
}
