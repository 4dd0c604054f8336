//! Input that cannot be reconstructed gives an error that names the camera or picture.

use facts::Shot;
use pcmvs_core::{Camera, Error, ImageRef, Mask, Params, PixelFormat, Preset, Rig, Serial, Silent, reconstruct};
use std::sync::LazyLock;
use studio::Subject;

static SHOT: LazyLock<Shot> = LazyLock::new(|| Shot::small(Subject::Sphere, 5));

fn refusal(change: impl FnOnce(&mut Shot)) -> Error {
    let mut shot = SHOT.clone();
    change(&mut shot);
    let error = Rig::new(&shot.cameras).and_then(|_| shot.reconstruct(&Params::preset(Preset::Default)).map(|_| ()));
    error.expect_err("this cannot be reconstructed")
}

#[test]
fn too_few_views() {
    let error = refusal(|shot| *shot = SHOT.of_cameras(&[0, 2]));
    assert_eq!(error, Error::TooFewViews { given: 2, needed: 3 });
    let error = refusal(|shot| shot.frame.masks.iter_mut().skip(2).for_each(|m| *m = None));
    assert_eq!(error, Error::TooFewViews { given: 2, needed: 3 });
}

#[test]
fn calibration_that_is_none() {
    let broken: [fn(&mut Camera); 7] = [
        |c| c.k[0][0] = f64::NAN,
        |c| c.t[1] = f64::INFINITY,
        |c| c.k[1][1] = 0.0,
        |c| c.k[2][2] = 2.0,
        |c| c.r[0].iter_mut().for_each(|v| *v = -*v),
        |c| c.r[0][0] += 0.1,
        |c| c.height = 0,
    ];
    for change in broken {
        let error = refusal(|shot| change(&mut shot.cameras[3]));
        assert!(matches!(error, Error::Camera { camera: 3, .. }), "{error}");
    }
}

#[test]
fn pictures_that_do_not_fit() {
    let error = refusal(|shot| shot.frame.images[2].width = 319);
    assert!(matches!(error, Error::Image { camera: 2, .. }), "{error}");
    let error = refusal(|shot| shot.frame.images[4].rgb.truncate(1000));
    assert!(matches!(error, Error::Image { camera: 4, .. }), "{error}");
    let error = refusal(|shot| shot.frame.images[1] = studio::Picture::default());
    assert!(matches!(error, Error::Image { camera: 1, .. }), "{error}");

    let (rig, mut inputs) = (SHOT.rig(), SHOT.inputs());
    let half = vec![255; 160 * 120];
    inputs[1].mask = Mask::Given(ImageRef::packed(&half, 160, 120, PixelFormat::Gray8));
    let error = reconstruct(&rig, &inputs, &Params::preset(Preset::Default), &Serial, &Silent).unwrap_err();
    assert!(matches!(error, Error::Silhouette { camera: 1, .. }), "{error}");
}

/// Turns every mask into that of the background.
fn invert(shot: &mut Shot) {
    shot.frame.masks.iter_mut().flatten().flatten().for_each(|v| *v = 255 - *v);
}

#[test]
fn masks_that_are_white_on_the_background() {
    assert_eq!(refusal(invert), Error::MasksInverted { inverted: 5, given: 5 });
}

/// Writes a camera's pose in another convention.
type Convention = fn(&Camera) -> Camera;

/// Poses in another convention, from that of the library, each with the words that only its own remedy has: OpenGL's
/// axes, the inverse, the centre in place of t, pictures upside down, OpenGL's axes in R alone, and a left-handed world.
fn conventions() -> [(&'static str, Convention); 6] {
    [
        ("the axes look like OpenGL", |c| Camera {
            r: [c.r[0], c.r[1].map(|v| -v), c.r[2].map(|v| -v)],
            t: [c.t[0], -c.t[1], -c.t[2]],
            ..*c
        }),
        ("R, t look like camera to world: ", |c| Camera {
            r: [0, 1, 2].map(|i| [0, 1, 2].map(|j| c.r[j][i])),
            t: c.centre().to_array(),
            ..*c
        }),
        ("t looks like the camera's centre: ", |c| Camera { t: c.centre().to_array(), ..*c }),
        ("the axes look like x left, y up, z forward", |c| Camera {
            r: [c.r[0].map(|v| -v), c.r[1].map(|v| -v), c.r[2]],
            t: [-c.t[0], -c.t[1], c.t[2]],
            ..*c
        }),
        ("R looks like that of OpenGL's axes", |c| Camera {
            r: [c.r[0], c.r[1].map(|v| -v), c.r[2].map(|v| -v)],
            ..*c
        }),
        ("the world looks left-handed", |c| {
            let [[a, b, c_], [d, e, f], [g, h, i]] = c.r;
            Camera { r: [[a, -b, -c_], [-d, e, f], [-g, h, i]], t: [-c.t[0], c.t[1], c.t[2]], ..*c }
        }),
    ]
}

#[test]
fn poses_in_another_convention_are_named() {
    for cameras in [5, 7, 12] {
        let figure = Shot::small(Subject::Figure, cameras);
        for (what, change) in conventions() {
            let error = refusal(|shot| {
                *shot = figure.clone();
                shot.cameras.iter_mut().for_each(|camera| *camera = change(camera));
            });
            let Error::Cameras { problem } = &error else { panic!("{what}: {error}") };
            assert!(problem.contains(what), "{cameras} cameras: {what}: {problem}");
        }
    }
}

/// Makes a mistake.
type Change = fn(&mut Shot);

/// Mirrors the pixels of a picture or of a mask.
fn mirror<T>(pixels: &mut [T], width: usize) {
    pixels.chunks_exact_mut(width).for_each(<[T]>::reverse);
}

/// Mirrors every picture and mask.
fn mirror_all(shot: &mut Shot) {
    for (image, mask) in shot.frame.images.iter_mut().zip(&mut shot.frame.masks) {
        let width = image.width as usize;
        mirror(image.rgb.as_chunks_mut::<3>().0, width);
        mirror(mask.as_mut().expect("all have masks"), width);
    }
}

/// Mistakes that all cameras share are named, with their remedy.
#[test]
fn mistakes_of_all_cameras_are_named() {
    let mistakes: [(&str, Change); 7] = [
        ("K looks like that of pictures 0.50 times as large", |shot| {
            shot.cameras.iter_mut().for_each(|c| c.k[..2].iter_mut().flatten().for_each(|v| *v *= 0.5));
        }),
        ("K has no principal point", |shot| {
            shot.cameras.iter_mut().for_each(|c| (c.k[0][2], c.k[1][2]) = (0.0, 0.0));
        }),
        ("cx and cy look exchanged", |shot| {
            shot.cameras.iter_mut().for_each(|c| (c.k[0][2], c.k[1][2]) = (c.k[1][2], c.k[0][2]));
        }),
        ("another order than the cameras, off by one", |shot| {
            shot.frame.images.rotate_left(1);
            shot.frame.masks.rotate_left(1);
        }),
        ("another order than the cameras, the reverse one", |shot| {
            shot.frame.images.reverse();
            shot.frame.masks.reverse();
        }),
        ("the pictures look mirrored", mirror_all),
        ("the pictures look turned by 180°", |shot| {
            mirror_all(shot);
            for (image, mask) in shot.frame.images.iter_mut().zip(&mut shot.frame.masks) {
                let width = image.width as usize;
                let flipped: Vec<u8> = image.rgb.chunks_exact(3 * width).rev().flatten().copied().collect();
                image.rgb = flipped;
                let mask = mask.as_mut().expect("all have masks");
                *mask = mask.chunks_exact(width).rev().flatten().copied().collect();
            }
        }),
    ];
    let figure = Shot::small(Subject::Figure, 7);
    for (what, make) in mistakes {
        let error = refusal(|shot| {
            *shot = figure.clone();
            make(shot);
        });
        let Error::Cameras { problem } = &error else { panic!("{what}: {error}") };
        assert!(problem.contains(what), "{what}: {problem}");
    }
}

#[test]
fn a_scaled_rotation_is_named_with_its_factor() {
    let error = refusal(|shot| shot.cameras[1].r.iter_mut().flatten().for_each(|v| *v *= 2.5));
    let Error::Camera { camera: 1, problem } = &error else { panic!("{error}") };
    assert!(problem.contains("2.5 times a rotation: divide R"), "{problem}");
}

/// Silhouettes whose cones do not intersect in space.
#[test]
fn an_empty_hull() {
    let error = refusal(|shot| {
        for (i, mask) in shot.frame.masks.iter_mut().enumerate() {
            // A spot in a corner of every picture, alternately at the top and at the bottom.
            let (x0, y0) = (10 + 280 * (i % 2), 10 + 200 * (i % 2));
            let mask = mask.as_mut().expect("all have masks");
            for (j, v) in mask.iter_mut().enumerate() {
                let (x, y) = (j % 320, j / 320);
                *v = if (x0..x0 + 20).contains(&x) && (y0..y0 + 20).contains(&y) { 255 } else { 0 };
            }
        }
    });
    assert_eq!(error, Error::EmptyHull);
}
