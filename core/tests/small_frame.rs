//! A whole frame as small as all stages take it: six views of a textured ball.

mod common;

use common::assert_manifold;
use glam::{DMat3, DVec3};
use pcmvs_core::{
    Camera, Frame, ImageRef, Lens, Mask, Memory, Params, PixelFormat, Preset, Rig, Serial, Silent, Stage, ViewInput,
};

const VIEWS: u32 = 6;
/// Edge of the pictures in pixels.
const SIZE: u32 = 24;
/// Radius of the ball around the origin, and distance of the cameras.
const RADIUS: f64 = 0.6;
const DISTANCE: f64 = 4.0;

/// A camera of a ring that looks at the origin from above.
fn camera(index: u32) -> Camera {
    let (sine, cosine) = libm::sincos(core::f64::consts::TAU * f64::from(index) / f64::from(VIEWS));
    let centre = DVec3::new(cosine, sine, 0.4).normalize() * DISTANCE;
    let ahead = -centre.normalize();
    let right = ahead.cross(DVec3::Z).normalize();
    let r = DMat3::from_cols(right, ahead.cross(right), ahead).transpose();
    let (focal, middle) = (2.4 * f64::from(SIZE), 0.5 * f64::from(SIZE - 1));
    Camera {
        width: SIZE,
        height: SIZE,
        k: [[focal, 0.0, middle], [0.0, focal, middle], [0.0, 0.0, 1.0]],
        lens: Lens::NONE,
        r: r.transpose().to_cols_array_2d(),
        t: (-(r * centre)).to_array(),
    }
}

/// What a camera sees of the ball before a green wall: the picture, and the mask.
fn taken(camera: &Camera) -> (Vec<u8>, Vec<u8>) {
    let (centre, r) = (camera.centre(), DMat3::from_cols_array_2d(&camera.r));
    let (mut rgb, mut mask) = (Vec::new(), Vec::new());
    for i in 0..SIZE * SIZE {
        let at = |i: u32, axis: usize| (f64::from(i) - camera.k[axis][2]) / camera.k[axis][axis];
        // The rows of `camera.r` are the columns of `r`, so that it maps from the camera to the world.
        let ray = (r * DVec3::new(at(i % SIZE, 0), at(i / SIZE, 1), 1.0)).normalize();
        let (along, footprint) = (-centre.dot(ray), DISTANCE / camera.k[0][0]);
        let within = RADIUS - (centre + ray * along).length();
        mask.push(((within / footprint + 0.5).clamp(0.0, 1.0) * 255.0) as u8);
        let depth = along - libm::sqrt((RADIUS * RADIUS - (RADIUS - within) * (RADIUS - within)).max(0.0));
        let p = (centre + ray * depth) * 14.0;
        let wave = |phase: f64| 128.0 + 45.0 * (libm::sin(p.x + phase) + libm::cos(p.y - phase) * libm::sin(p.z));
        let ball = [wave(0.0), wave(0.3), wave(0.6)];
        let wall = [40.0, 160.0, 60.0];
        rgb.extend(if within > 0.0 { ball } else { wall }.map(|v| v as u8));
    }
    (rgb, mask)
}

fn input((rgb, mask): &(Vec<u8>, Vec<u8>)) -> ViewInput<'_> {
    ViewInput {
        image: ImageRef::packed(rgb, SIZE, SIZE, PixelFormat::Rgb8),
        mask: Mask::Given(ImageRef::packed(mask, SIZE, SIZE, PixelFormat::Gray8)),
    }
}

#[test]
fn every_stage_of_a_small_frame_runs() {
    let cameras: Vec<Camera> = (0..VIEWS).map(camera).collect();
    let taken: Vec<_> = cameras.iter().map(taken).collect();
    let inputs: Vec<ViewInput> = taken.iter().map(input).collect();
    let rig = Rig::new(&cameras).expect("the cameras are sound");
    let mut frame = Frame::new(&rig, Params::preset(Preset::Default), Memory::default());
    frame.run_all(&inputs, &Serial, &Silent).expect("the ball is in all views");
    let stages = frame.intermediates();
    assert!(stages.detected.iter().any(|points| !points.is_empty()), "stereo finds points");
    assert!(!stages.merged.is_empty() && !frame.mesh().colours.is_empty());
    assert!(frame.require(Stage::Colour).is_ok());
    assert_manifold(frame.mesh());
    let radius = |p: &glam::Vec3| (p.as_dvec3() + rig.origin()).length();
    let mean = frame.mesh().positions.iter().map(radius).sum::<f64>() / frame.mesh().positions.len() as f64;
    assert!((mean / RADIUS - 1.0).abs() < 0.1, "{mean}");
}
