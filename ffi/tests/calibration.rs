//! C's calibration is the core's: the same cameras, bit by bit, and the same figures.

#![allow(unsafe_code, reason = "it calls the library as C does")]

mod common;

use pcmvs::{
    calibration::{pcmvs_calibration_add_frame, pcmvs_calibration_free, pcmvs_calibration_new, pcmvs_calibration_run},
    calibration_options::{pcmvs_calibration_options, pcmvs_calibration_options_init},
    calibration_report::{
        pcmvs_calibration_get_camera, pcmvs_calibration_get_camera_report, pcmvs_calibration_get_report,
        pcmvs_calibration_report, pcmvs_camera_report,
    },
    camera::{pcmvs_camera, pcmvs_camera_init},
    image::{pcmvs_image, pcmvs_image_init},
    pixel_format::pcmvs_pixel_format,
    rig::{pcmvs_rig_free, pcmvs_rig_new, pcmvs_rig_set_cameras},
    status::pcmvs_status,
    view::{pcmvs_view, pcmvs_view_init},
};
use pcmvs_core::{
    Camera, ImageRef, Mask, Params, PixelFormat, Preset, Rig, Serial, Silent, View, ViewInput,
    calibration::{Calibration, CalibrationParams, calibrate},
};
use std::{
    mem::{MaybeUninit, size_of},
    ptr::{null, null_mut},
};
use studio::Capture;

/// A struct that a function of the library writes.
fn filled<T>(write: impl FnOnce(*mut T, usize) -> pcmvs_status) -> T {
    let mut value = MaybeUninit::zeroed();
    assert_eq!(write(value.as_mut_ptr(), size_of::<T>()), pcmvs_status::Ok);
    // SAFETY: all of it has been written.
    unsafe { value.assume_init() }
}

fn ok(status: pcmvs_status) {
    assert_eq!(status, pcmvs_status::Ok);
}

fn by_core(capture: &Capture, intrinsics: bool) -> Calibration {
    let rig = Rig::new(&capture.cameras).unwrap();
    let contour = Params::preset(Preset::Default).contour;
    let view = |&camera: &u32| {
        let camera = camera as usize;
        let Camera { width, height, .. } = capture.cameras[camera];
        let mask = capture.frames[0].masks[camera].as_deref().unwrap();
        let input = ViewInput {
            image: ImageRef::packed(&capture.frames[0].images[camera].rgb, width, height, PixelFormat::Rgb8),
            mask: Mask::Given(ImageRef::packed(mask, width, height, PixelFormat::Gray8)),
        };
        View::new(&rig, camera, &input, contour.as_ref()).unwrap()
    };
    let views: Vec<View> = rig.order().iter().map(view).collect();
    let params = CalibrationParams { intrinsics, ..CalibrationParams::default() };
    calibrate(&rig, &[&views], &params, &Serial, &Silent).unwrap()
}

/// What C returns: the cameras, their reports, and the report of the whole.
type ByC = (Vec<pcmvs_camera>, Vec<pcmvs_camera_report>, pcmvs_calibration_report);

fn by_c(capture: &Capture, intrinsics: bool) -> ByC {
    let list = |m: [[f64; 3]; 3]| [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i| m[i / 3][i % 3]);
    let camera = |camera: &Camera| {
        let Camera { width, height, k, lens, r, t } = *camera;
        let mut distortion = [0.0; 5];
        distortion.copy_from_slice(&lens.coefficients()[..5]);
        // SAFETY: the pointer and the size are those of the struct.
        let init = filled::<pcmvs_camera>(|target, size| unsafe { pcmvs_camera_init(target, size) });
        pcmvs_camera { width, height, k: list(k), distortion, r: list(r), t, ..init }
    };
    let cameras: Vec<pcmvs_camera> = capture.cameras.iter().map(camera).collect();
    let image = |pixels: &[u8], i: usize, format: pcmvs_pixel_format| {
        // SAFETY: as above.
        let init = filled::<pcmvs_image>(|target, size| unsafe { pcmvs_image_init(target, size) });
        let Camera { width, height, .. } = capture.cameras[i];
        pcmvs_image { format: format as u32, width, height, data: pixels.as_ptr().cast(), ..init }
    };
    let frame = &capture.frames[0];
    let count = cameras.len();
    let pictures: Vec<_> = (0..count).map(|i| image(&frame.images[i].rgb, i, pcmvs_pixel_format::Rgb8)).collect();
    let mask = |i: usize| image(frame.masks[i].as_deref().unwrap(), i, pcmvs_pixel_format::Gray8);
    let masks: Vec<_> = (0..count).map(mask).collect();
    let view = |i: usize| {
        // SAFETY: as above.
        let init = filled::<pcmvs_view>(|target, size| unsafe { pcmvs_view_init(target, size) });
        pcmvs_view { image: &raw const pictures[i], mask: &raw const masks[i], ..init }
    };
    let views: Vec<_> = (0..count).map(view).collect();
    // SAFETY: handles are valid until they are freed; counts and sizes are those of the arrays and structs.
    unsafe {
        let options = filled::<pcmvs_calibration_options>(|target, size| pcmvs_calibration_options_init(target, size));
        let options = pcmvs_calibration_options { intrinsics: u32::from(intrinsics), ..options };
        let (mut rig, mut calibration) = (null_mut(), null_mut());
        ok(pcmvs_rig_new(&raw mut rig));
        ok(pcmvs_rig_set_cameras(rig, cameras.as_ptr(), count));
        ok(pcmvs_calibration_new(rig, &raw mut calibration));
        ok(pcmvs_rig_free(rig));
        ok(pcmvs_calibration_add_frame(calibration, views.as_ptr(), count, null()));
        ok(pcmvs_calibration_run(calibration, &raw const options));
        let indices = 0..count as u32;
        let camera = |i| filled(|target, size| pcmvs_calibration_get_camera(calibration, i, target, size));
        let report = |i| filled(|target, size| pcmvs_calibration_get_camera_report(calibration, i, target, size));
        let cameras = indices.clone().map(camera).collect();
        let reports = indices.map(report).collect();
        let whole = filled(|target, size| pcmvs_calibration_get_report(calibration, target, size));
        ok(pcmvs_calibration_free(calibration));
        (cameras, reports, whole)
    }
}

/// All numbers of a camera, bit by bit.
fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u64> {
    numbers.into_iter().map(f64::to_bits).collect()
}

#[test]
fn c_finds_what_the_core_finds() {
    let capture = common::plain::one_turned();
    for intrinsics in [false, true] {
        let expected = by_core(&capture, intrinsics);
        let (cameras, reports, whole) = by_c(&capture, intrinsics);
        for ((found, of_core), report) in
            cameras.iter().zip(&expected.cameras).zip(expected.reports.iter().zip(&reports))
        {
            let Camera { width, height, k, lens, r, t } = *of_core;
            assert_eq!((found.width, found.height), (width, height));
            let own =
                found.k.into_iter().chain(found.distortion).chain(found.distortion_more).chain(found.r).chain(found.t);
            let core = k.as_flattened().iter().chain(lens.coefficients()).chain(r.as_flattened()).chain(&t);
            assert_eq!(bits(own), bits(core.copied()));
            let (of_core, found) = report;
            let figures = [
                (found.silhouette_overlap, of_core.silhouette_overlap),
                (found.gain, of_core.gain),
                (found.contour_px, of_core.given.contour_px),
                (found.refined_contour_px, of_core.refined.contour_px),
                (found.epipolar_px, of_core.given.epipolar_px),
                (found.refined_epipolar_px, of_core.refined.epipolar_px),
                (found.match_noise_px, of_core.given.noise_px),
                (found.moved_px, Some(of_core.moved_px)),
                (found.sigma_px, of_core.uncertainty.map(|of| of.object_px)),
                (found.direction_sigma_px, of_core.uncertainty.map(|of| of.direction_px)),
                (found.roll_sigma_px, of_core.uncertainty.map(|of| of.roll_px)),
                (found.centre_sigma_px, of_core.uncertainty.map(|of| of.centre_px)),
            ];
            for (i, (found, of_core)) in figures.into_iter().enumerate() {
                assert_eq!(found, of_core.map_or(-1.0, |value| value as f32), "figure {i}");
            }
            assert_eq!(found.matches, of_core.given.matches);
        }
        let loss = expected.held_out.unwrap().map(|value| value as f32);
        let bias = expected.epipolar_bias_px.unwrap().map(|value| value as f32);
        assert_eq!([whole.held_out_loss, whole.refined_held_out_loss], loss);
        assert_eq!([whole.epipolar_bias_px, whole.refined_epipolar_bias_px], bias);
        assert_eq!((whole.points, whole.frames), (expected.points, 1));
    }
}
