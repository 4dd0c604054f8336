//! A view that shows nothing of the object contributes nothing and is named; the frame is made from the others.

use facts::{Errors, Shot, topology::assert_sound};
use pcmvs_core::{
    Camera, Frame, Memory, Params, Preset, Reconstruction, Serial, Silent, ViewInput, Warning, silhouette::ContourFault,
};
use std::sync::LazyLock;
use studio::{Capture, Faults, Ring, Subject};

static SHOT: LazyLock<Shot> = LazyLock::new(|| {
    let ring = Ring { count: 12, ..Ring::default() }.sized(320, 240);
    Shot::new(Subject::TwoBodies, &ring.cameras(), &Faults::default())
});

fn made(shot: &Shot, preset: Preset, inputs: &[Option<ViewInput>]) -> Reconstruction {
    let rig = shot.rig();
    let mut frame = Frame::new(&rig, Params::preset(preset), Memory::default());
    frame.run_all(inputs, &Serial, &Silent).expect("the other views are enough");
    frame.into_reconstruction()
}

fn made_of(shot: &Shot) -> Reconstruction {
    made(shot, Preset::Default, &inputs(shot))
}

fn inputs<'s>(shot: &'s Shot) -> Vec<Option<ViewInput<'s>>> {
    shot.inputs().into_iter().map(Some).collect()
}

/// Checks that a view is left out with a warning, and that the mesh is as good as without its camera.
fn assert_left_out(shot: &Shot, made: &Reconstruction, camera: usize, warning: &Warning) {
    let what = warning.code();
    assert_eq!(made.warnings, core::slice::from_ref(warning), "{what}");
    assert_sound(&made.mesh, what);
    for (i, found) in made.diagnostics.iter().enumerate() {
        assert_eq!(found.used, i != camera, "{what}: camera {i}");
    }
    assert_eq!(made.gains[camera], [1.0; 3], "{what}");
    let place = shot.rig().place(camera).expect("the rig has it") as u16;
    let of_view = |points: &[pcmvs_core::Point]| points.iter().any(|p| p.view == place);
    let stages = &made.intermediates;
    assert!(!of_view(&stages.frontier) && !of_view(&stages.merged) && stages.detected[place as usize].is_empty());
    let others: Vec<usize> = (0..shot.cameras.len()).filter(|&i| i != camera).collect();
    Errors::new(&shot.of_cameras(&others), &made.mesh).assert_within(0.9, 1.3, what);
}

#[test]
fn a_camera_without_picture() {
    let mut inputs = inputs(&SHOT);
    inputs[4] = None;
    let made = made(&SHOT, Preset::Default, &inputs);
    assert_left_out(&SHOT, &made, 4, &Warning::NoPicture { camera: 4 });
}

#[test]
fn a_mask_without_the_object() {
    let mut shot = SHOT.clone();
    shot.frame.masks[4].iter_mut().flatten().for_each(|v| *v = 0);
    let made = made_of(&shot);
    assert_left_out(&shot, &made, 4, &Warning::EmptySilhouette { camera: 4 });
}

#[test]
fn a_mask_that_is_white_on_the_background() {
    let mut shot = SHOT.clone();
    shot.frame.masks[4].iter_mut().flatten().for_each(|v| *v = 255 - *v);
    let made = made_of(&shot);
    assert_left_out(&shot, &made, 4, &Warning::MaskInverted { camera: 4 });
}

/// A camera that looks past the object, without a mask and with one that is a speck.
#[test]
fn an_object_beside_the_picture() {
    let mut shot = SHOT.clone();
    let camera = &SHOT.cameras[4];
    // Its principal point lies two pictures to the left.
    shot.cameras[4] = Camera { k: [[camera.k[0][0], 0.0, -640.0], camera.k[1], camera.k[2]], ..*camera };
    for speck in [false, true] {
        shot.frame.masks[4] = speck.then(|| {
            (0..320 * 240)
                .map(|i| if (100..104).contains(&(i % 320)) && (100..104).contains(&(i / 320)) { 255 } else { 0 })
                .collect()
        });
        let made = made_of(&shot);
        assert_left_out(&shot, &made, 4, &Warning::ObjectBesidePicture { camera: 4 });
    }
}

/// Nothing is known from a mask that is white everywhere, except that the picture shows nothing but the object.
#[test]
fn a_mask_that_fills_the_picture_does_not_carve() {
    let mut shot = SHOT.clone();
    shot.frame.masks[4].iter_mut().flatten().for_each(|v| *v = 255);
    let made = made_of(&shot);
    assert_eq!(made.warnings, [Warning::FullSilhouette { camera: 4 }]);
    assert!(made.diagnostics[4].used && made.diagnostics[4].contour_px.is_none());
    Errors::new(&shot, &made.mesh).assert_within(0.9, 1.0, "a full mask");
}

/// One camera twice: nothing divides by the zero distance, and no ray takes the contour of its twin for a touch.
#[test]
fn two_cameras_at_the_same_place() {
    let twice = SHOT.of_cameras(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 4]);
    let made = made_of(&twice);
    assert_eq!(made.warnings, [Warning::SamePlace { first: 4, second: 12 }]);
    assert_sound(&made.mesh, "twice");
    Errors::new(&SHOT, &made.mesh).assert_within(0.9, 1.0, "twice");
    let once = made_of(&SHOT);
    let places = [4, 12].map(|camera| twice.rig().place(camera).expect("the rig has it") as u16);
    let place = SHOT.rig().place(4).expect("the rig has it") as u16;
    let from = |found: &Reconstruction, places: &[u16]| {
        found.intermediates.frontier.iter().filter(|p| places.contains(&p.view)).count()
    };
    let (pair, single) = (from(&made, &places), from(&once, &[place]));
    assert!(pair.abs_diff(2 * single) <= single / 50, "{pair} frontier points of the pair, {single} of one");
}

/// The overlap is that of the true outlines but for what the grid loses, and a shifted mask is named.
#[test]
fn silhouettes_that_agree_and_one_that_does_not() {
    let good = made_of(&SHOT);
    assert_eq!(good.warnings, []);
    for found in &good.diagnostics {
        assert!(found.used && found.silhouette_overlap.is_some_and(|overlap| overlap > 0.97), "{found:?}");
        assert!(found.contour_px.is_some_and(|pixels| pixels < 0.3), "{found:?}");
    }
    let mut shot = SHOT.clone();
    shot.cameras[4].k[0][2] += 8.0;
    let moved = made(&shot, Preset::Hull, &inputs(&shot));
    let named = moved.warnings.iter().filter_map(|warning| match warning {
        Warning::SilhouetteDisagrees { camera, .. } | Warning::CameraContradicts { camera, .. } => Some(*camera),
        _ => None,
    });
    assert_eq!(named.collect::<Vec<_>>(), [4]);
}

/// The shape does not suffer from a picture that is a third as bright as the others, and its camera is named.
#[test]
fn a_picture_that_is_much_darker_is_named() {
    let mut shot = SHOT.clone();
    shot.frame.images[4].rgb.iter_mut().for_each(|v| *v /= 3);
    let made = made_of(&shot);
    let [Warning::ColoursDiffer { camera: 4, gains }] = made.warnings[..] else { panic!("{:?}", made.warnings) };
    assert!(gains.iter().all(|gain| (2.0..3.5).contains(gain)), "{gains:?}");
    Errors::new(&shot, &made.mesh).assert_within(0.9, 1.3, "a dark picture");
}

/// What is wrong with all silhouettes alike does not make them contradict each other, but the pictures show it.
#[test]
fn masks_that_are_all_too_wide_or_too_narrow_are_named() {
    let ring = Ring { count: 6, ..Ring::default() }.sized(320, 240);
    for wider in [16.0, -9.0, -5.0] {
        let faults = Faults { wider_masks: wider, ..Faults::default() };
        let shot = Shot::new(Subject::TwoBodies, &ring.cameras(), &faults);
        let made = made(&shot, Preset::Hull, &inputs(&shot));
        let named = made.warnings.iter().find_map(|warning| match warning {
            Warning::Contour(ContourFault::BesideEdges { pixels }) => Some(f64::from(*pixels)),
            _ => None,
        });
        assert!(named.is_some_and(|pixels| (0.75..1.25).contains(&(pixels / wider))), "{wider}: {:?}", made.warnings);
    }
}

/// Masks of a dancer a moment later do not follow the outlines in the pictures, and no single camera is to blame.
#[test]
fn masks_of_another_instant_than_the_pictures_are_named() {
    let cameras = Ring { count: 8, ..Ring::default() }.sized(640, 480).cameras();
    let named = |later: f64| {
        let mut capture = Capture::new(Subject::Figure, &cameras, &[0.0, later], &Faults::default());
        let next = capture.frames.remove(1);
        let mut shot = Shot { cameras: capture.cameras, frame: capture.frames.remove(0) };
        shot.frame.masks = next.masks;
        made(&shot, Preset::Hull, &inputs(&shot)).warnings
    };
    assert_eq!(named(0.0), []);
    let warnings = named(0.6);
    let is_across = |warning: &Warning| matches!(warning, Warning::Contour(ContourFault::AcrossEdges { .. }));
    let is_about_mask = |warning: &Warning| is_across(warning) || matches!(warning, Warning::SilhouetteSetAside { .. });
    assert!(warnings.iter().any(is_across) && warnings.iter().all(is_about_mask), "{warnings:?}");
}

/// A camera out of focus is named, and its mask, which is right, is not accused.
#[test]
fn a_camera_out_of_focus_is_named() {
    let cameras = Ring { count: 8, ..Ring::default() }.sized(640, 480).cameras();
    let mut shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
    let blurred = Shot::new(Subject::Figure, &cameras, &Faults { blur: 3.0, ..Faults::default() });
    assert_eq!(made(&blurred, Preset::Hull, &inputs(&blurred)).warnings, [], "all cameras are equally soft");
    shot.frame.images[4] = blurred.frame.images[4].clone();
    let warnings = made(&shot, Preset::Hull, &inputs(&shot)).warnings;
    let [Warning::Contour(ContourFault::Blurred { camera: 4, pixels, usual })] = warnings[..] else {
        panic!("{warnings:?}")
    };
    assert!((5.0..10.0).contains(&pixels) && usual < 4.0, "{warnings:?}");
}

/// A camera that contradicts the others is at fault if its mask follows its picture, and its mask is if it was shifted.
#[test]
fn a_camera_that_was_moved_is_told_from_a_mask_that_was_shifted() {
    let cameras = Ring { count: 8, ..Ring::default() }.sized(640, 480).cameras();
    let shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
    let mut moved = shot.clone();
    moved.cameras[4].k[0][2] += 40.0;
    let warnings = made(&moved, Preset::Hull, &inputs(&moved)).warnings;
    assert!(matches!(warnings[..], [Warning::CameraContradicts { camera: 4, mask_follows: true, .. }]), "{warnings:?}");
    let mut shifted = shot.clone();
    shifted.frame.masks[4].as_mut().expect("every camera has one").rotate_right(8);
    let warnings = made(&shifted, Preset::Hull, &inputs(&shifted)).warnings;
    let is_named = |warning: &Warning| matches!(warning, Warning::Contour(ContourFault::AcrossEdge { camera: 4, .. }));
    assert!(
        warnings.iter().any(is_named) && warnings.iter().all(|warning| warning.camera() == Some(4)),
        "{warnings:?}"
    );
    let is_blamed = |warning: &Warning| matches!(warning, Warning::CameraContradicts { mask_follows: true, .. });
    assert!(!warnings.iter().any(is_blamed), "{warnings:?}");
}
