//! A limb that one frame's silhouettes lack comes back from the frames before and after, if the pictures show it.

use facts::{Shot, threads, topology::assert_sound};
use glam::DVec3;
use pcmvs_core::{Error, Frame, Memory, Mesh, Params, Preset, Rig, Silent, Warning, lost_part::Beside};
use studio::{Capture, Faults, Ring, Subject, score};

const CAMERAS: usize = 12;
/// Seconds between two frames.
const PERIOD: f64 = 1.0 / 30.0;

fn take<const N: usize>(times: [f64; N]) -> [Shot; N] {
    let cameras = Ring { count: CAMERAS as u32, ..Ring::default() }.sized(400, 300).cameras();
    let faults = Faults { noise: 3.0, ..Faults::default() };
    let capture = Capture::new(Subject::Standing, &cameras, &times, &faults);
    let shots = capture.frames.into_iter().map(|frame| Shot { cameras: capture.cameras.clone(), frame });
    shots.collect::<Vec<_>>().try_into().ok().expect("there is one frame per time")
}

/// Points of the arm that waves, with their normals.
fn arm(shot: &Shot) -> Vec<(DVec3, DVec3)> {
    let is_arm = |p: DVec3| p.y < -0.32 && p.z > 0.8;
    shot.truth().surface_points(60_000, 0).into_iter().filter(|&(p, _)| is_arm(p)).collect()
}

/// Takes the arm out of the masks of some cameras.
fn erase_arm(shot: &mut Shot, cameras: &[usize]) {
    let points = arm(shot);
    for &index in cameras {
        let camera = shot.cameras[index];
        let seen = points.iter().filter(|&&(p, normal)| score::sees(shot.truth(), &camera, p, normal));
        let seen: Vec<_> = seen.filter_map(|&(p, _)| camera.project(p)).map(|(pixel, _)| pixel).collect();
        let mask = shot.frame.masks[index].as_mut().expect("all cameras have masks");
        for pixel in seen {
            let (x, y) = (pixel.x.round() as i64, pixel.y.round() as i64);
            for (x, y) in (-3..=3).flat_map(|down| (-3..=3).map(move |right| (x + right, y + down))) {
                if (0..i64::from(camera.width)).contains(&x) && (0..i64::from(camera.height)).contains(&y) {
                    mask[(y * i64::from(camera.width) + x) as usize] = 0;
                }
            }
        }
    }
}

/// A frame that is made by itself.
fn own<'a>(shot: &Shot, rig: &'a Rig) -> Frame<&'a Rig> {
    let mut frame = Frame::new(rig, Params::preset(Preset::Default), Memory::default());
    frame.run_all(&shot.inputs(), &threads(2), &Silent).expect("faults are no errors");
    frame
}

/// The middle frame, made with its neighbours' pictures: its mesh, its warnings, and the number of silhouettes that got
/// something added.
fn restored(shots: [&Shot; 3], rig: &Rig, count: usize) -> (Mesh, Vec<Warning>, u32) {
    let mut frame = Frame::new(rig, Params::preset(Preset::Default), Memory::default());
    let [before, own, after] = shots.map(Shot::inputs);
    let threads = threads(count);
    let cameras = frame.read_views_between::<Error>(&threads, &Silent, |camera, give| {
        give(Some(&own[camera]), [Some(&before[camera]), Some(&after[camera])])
    });
    let cameras = cameras.expect("the studio's pictures are sound");
    frame.run_stages(&threads, &Silent).expect("the studio's frames are sound");
    assert_sound(frame.mesh(), "restored");
    (frame.mesh().clone(), frame.warnings(), cameras)
}

/// Share of the arm that lies within three footprints of a mesh.
fn arm_share(shot: &Shot, mesh: &Mesh) -> f64 {
    let footprint = shot.footprint(shot.rig().origin());
    score::completeness(&arm(shot), &shot.in_world(mesh), 3.0 * footprint)
}

#[test]
fn an_arm_that_the_masks_of_one_frame_lack_comes_back() {
    let whole = take([0.0, PERIOD, 2.0 * PERIOD]);
    let rig = whole[1].rig();
    let [before, complete, after] = whole.each_ref().map(|shot| own(shot, &rig));
    let share = arm_share(&whole[1], complete.own_mesh());
    assert!(share > 0.95, "{share}");
    for lacking in [vec![0, 2, 3, 6, 9], (0..CAMERAS).collect()] {
        let mut shots = whole.clone();
        erase_arm(&mut shots[1], &lacking);
        let frame = own(&shots[1], &rig);
        let left = arm_share(&shots[1], frame.own_mesh());
        assert!(left < 0.7, "{} cameras lack the arm: {left} is there", lacking.len());
        let beside = [&before, &after].map(|other| Beside { mesh: other.own_mesh(), overruled: &[] });
        assert!(frame.may_have_lost_part(beside, &threads(2)).expect("it is complete"));
        let (mesh, warnings, cameras) = restored(shots.each_ref(), &rig, 2);
        let back = arm_share(&shots[1], &mesh);
        println!(
            "{} cameras lack the arm: {left:.3} of it is there, then {back:.3}; complete {share:.3}",
            lacking.len()
        );
        assert!(back > share - 0.04, "{back} of the arm is there instead of {share}");
        assert!(cameras as usize >= lacking.len() - 2 && cameras as usize <= lacking.len(), "{cameras} cameras");
        let named: Vec<_> = warnings.iter().filter(|w| w.code() == "silhouette-restored").collect();
        assert!(
            named.iter().all(|w| w.camera().is_some_and(|camera| lacking.contains(&(camera as usize)))),
            "{named:?}"
        );
        assert_eq!(named.len(), cameras as usize, "{warnings:?}");
        assert!(mesh == restored(shots.each_ref(), &rig, 1).0, "the result depends on the number of threads");
    }
}

/// Pictures are not read again for nothing: the same cameras' masks are bad in all frames, or the arm moves fast.
#[test]
fn frames_that_have_lost_nothing_are_told_by_their_neighbours_without_pictures() {
    for (times, lacking) in [([0.0, PERIOD, 2.0 * PERIOD], &[0, 6][..]), ([0.0, 0.1, 0.2], &[])] {
        let mut shots = take(times);
        shots.iter_mut().for_each(|shot| erase_arm(shot, lacking));
        let rig = shots[1].rig();
        let frames = shots.each_ref().map(|shot| own(shot, &rig));
        let overruled = frames.each_ref().map(Frame::overruled);
        let expected: Vec<u32> = lacking.iter().map(|&camera| camera as u32).collect();
        assert_eq!(overruled, [(); 3].map(|()| expected.clone()));
        let beside = |i: usize| Beside { mesh: frames[i].own_mesh(), overruled: &overruled[i] };
        let may_have = |beside| frames[1].may_have_lost_part(beside, &threads(2)).expect("it is complete");
        assert!(!may_have([beside(0), beside(2)]), "{times:?}");
        // In a frame alone, as many of them are a reason to look.
        let right = [0, 2].map(|i| Beside { overruled: &[], ..beside(i) });
        assert_eq!(may_have(right), !lacking.is_empty());
    }
}

/// The pictures of a frame whose masks lack nothing have nothing to add, also if the arm has really moved away meanwhile.
#[test]
fn what_the_pictures_do_not_show_does_not_come_back() {
    for times in [[0.0, PERIOD, 2.0 * PERIOD], [0.0, 0.5, 2.0 * PERIOD], [0.25, 0.75, 0.25]] {
        let shots = take(times);
        let rig = shots[1].rig();
        let (mesh, warnings, cameras) = restored(shots.each_ref(), &rig, 2);
        assert_eq!((cameras, warnings), (0, vec![]), "{times:?}");
        assert!(mesh == *own(&shots[1], &rig).own_mesh(), "{times:?}");
    }
}

/// Checks which of the frames beyond its neighbours a frame asks for, and that it may have lost a part that the frames `around`
/// have.
fn assert_asks(frame: &Frame<&Rig>, neighbours: [Beside; 2], around: [Beside; 2], asks: [bool; 2]) {
    assert_eq!(frame.look_beyond(neighbours, &threads(2)).expect("it is complete"), asks);
    assert!(frame.may_have_lost_part(around, &threads(2)).expect("it is complete"));
}

/// In the first frame that lacks the arm, the one after it lacks it, too, and the frame beyond that one tells. In the second
/// frame it is the other way round.
#[test]
fn an_arm_that_the_masks_of_two_frames_lack_comes_back() {
    let whole = take([0.0, PERIOD, 2.0 * PERIOD, 3.0 * PERIOD]);
    let rig = whole[1].rig();
    let complete = whole.each_ref().map(|shot| own(shot, &rig));
    for lacking in [vec![0, 2, 3, 6, 9], (0..CAMERAS).collect()] {
        let mut shots = whole.clone();
        shots[1..3].iter_mut().for_each(|shot| erase_arm(shot, &lacking));
        let middle = [1, 2].map(|i| own(&shots[i], &rig));
        let frames = [&complete[0], &middle[0], &middle[1], &complete[3]];
        let overruled = frames.map(Frame::overruled);
        let beside = |i: usize| Beside { mesh: frames[i].own_mesh(), overruled: &overruled[i] };
        for (i, asks) in [(1, [false, true]), (2, [true, false])] {
            assert_asks(frames[i], [i - 1, i + 1].map(beside), [0, 3].map(beside), asks);
            let (mesh, _, cameras) = restored([&shots[0], &shots[i], &shots[3]], &rig, 2);
            let meshes = [frames[i].own_mesh(), &mesh, complete[i].own_mesh()];
            let [left, back, share] = meshes.map(|mesh| arm_share(&shots[i], mesh));
            println!(
                "{} cameras lack the arm in two frames: {left:.3} of it is there, then {back:.3}; complete {share:.3}",
                lacking.len()
            );
            assert!(left < 0.7 && back > share - 0.04, "{back} of the arm is there instead of {share}, before {left}");
            assert!(cameras as usize >= lacking.len() - 2 && cameras as usize <= lacking.len(), "{cameras} cameras");
        }
    }
    // Frames that have the arm ask for nothing, although the one beside them lacks it or they are complete.
    let overruled = complete.each_ref().map(Frame::overruled);
    let beside = |i: usize| Beside { mesh: complete[i].own_mesh(), overruled: &overruled[i] };
    assert_eq!(complete[1].look_beyond([beside(0), beside(2)], &threads(2)).expect("it is complete"), [false; 2]);
}

/// The arm is really elsewhere in two frames in a row. They ask for the frames around them, and the pictures show no arm.
#[test]
fn an_arm_that_is_withdrawn_for_two_frames_is_not_invented() {
    let shots = take([0.25, 0.75, 0.75, 0.25]);
    let rig = shots[1].rig();
    let frames = shots.each_ref().map(|shot| own(shot, &rig));
    let overruled = frames.each_ref().map(Frame::overruled);
    let beside = |i: usize| Beside { mesh: frames[i].own_mesh(), overruled: &overruled[i] };
    for (i, asks) in [(1, [false, true]), (2, [true, false])] {
        assert_asks(&frames[i], [i - 1, i + 1].map(beside), [0, 3].map(beside), asks);
        let (mesh, warnings, cameras) = restored([&shots[0], &shots[i], &shots[3]], &rig, 2);
        assert_eq!((cameras, warnings), (0, vec![]));
        assert!(mesh == *frames[i].own_mesh());
    }
}
