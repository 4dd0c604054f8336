//! Calls of the C library in an order that the fuzzer chooses, two frames of one rig and a handle that was freed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pcmvs::{
    camera::pcmvs_camera,
    cloud::{pcmvs_frame_copy_cloud, pcmvs_frame_get_silhouette},
    export::pcmvs_frame_export_mesh_to_buffer,
    frame::*,
    image::{pcmvs_image, pcmvs_image_init},
    mesh::pcmvs_frame_get_mesh,
    options::{pcmvs_options, pcmvs_options_init},
    report::{pcmvs_frame_get_counts, pcmvs_frame_get_view_report},
    rig::*,
    status::pcmvs_status,
    view::{pcmvs_view, pcmvs_view_init},
    warning::{pcmvs_frame_get_warning, pcmvs_frame_warning_count},
};
use pcmvs_fuzz::{Bytes, camera, init, ring};
use std::{
    ffi::{c_int, c_void},
    mem::MaybeUninit,
    ptr::{null, null_mut},
};

const SIZE: u32 = 16;
const CAMERAS: usize = 3;

/// Cancels when it has been asked so many times.
unsafe extern "C" fn progress(left: *mut c_void, _: u32, _: u32, _: u32) -> c_int {
    // SAFETY: `left` is the target's number.
    let left = unsafe { &mut *left.cast::<i32>() };
    *left -= 1;
    c_int::from(*left == 0)
}

/// Planes of one view.
struct Planes {
    picture: Vec<u8>,
    mask: Vec<u8>,
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes(bytes);
    let pixels = (SIZE * SIZE) as usize;
    let planes: Vec<Planes> = (0..CAMERAS)
        .map(|camera| {
            let radius = 16 + bytes.below(32) as i32;
            let inside = |i: usize| {
                let (x, y) = (i as i32 % SIZE as i32 - 8, i as i32 / SIZE as i32 - 8);
                if x * x + y * y < radius { 255 } else { 0 }
            };
            let picture = (0..3 * pixels).map(|i| (i * (3 + camera) + i / 7) as u8).collect();
            Planes { picture, mask: (0..pixels).map(inside).collect() }
        })
        .collect();
    let image = |data: &[u8], format: u32| {
        let mut image = init(pcmvs_image_init);
        (image.width, image.height, image.format, image.data) = (SIZE, SIZE, format, data.as_ptr().cast());
        image
    };
    let images: Vec<[pcmvs_image; 2]> = planes.iter().map(|p| [image(&p.picture, 1), image(&p.mask, 0)]).collect();
    let view = |[picture, mask]: &[pcmvs_image; 2]| {
        let mut view: pcmvs_view = init(pcmvs_view_init);
        (view.image, view.mask) = (picture, mask);
        view
    };
    let views: Vec<pcmvs_view> = images.iter().map(view).collect();
    let cameras: Vec<pcmvs_camera> = ring(CAMERAS as u32, SIZE).iter().map(camera).collect();
    let (mut rig, mut frames, mut stale) = (null_mut(), [null_mut(); 2], null_mut());
    let mut left = 0i32;
    let ok = |status| assert_eq!(status, pcmvs_status::Ok);
    // SAFETY: handles may be anything, all other pointers hold what they say.
    unsafe {
        ok(pcmvs_rig_new(&mut rig));
        ok(pcmvs_rig_set_cameras(rig, cameras.as_ptr(), cameras.len()));
        frames.iter_mut().for_each(|frame| ok(pcmvs_frame_new(rig, frame)));
        let mut calls = 0;
        while !bytes.is_empty() && calls < 60 {
            calls += 1;
            let place = bytes.below(9);
            let frame = if place == 8 { stale } else { frames[place % 2] };
            let index = bytes.below(CAMERAS + 1) as u32;
            let view = &views[index as usize % CAMERAS];
            let mut options: pcmvs_options = init(pcmvs_options_init);
            options.preset = bytes.below(5) as u32;
            options.progress = Some(progress);
            options.progress_user = (&raw mut left).cast();
            let mut buffer = [0u8; 4096];
            let mut count = 0;
            let status = match bytes.below(18) {
                0 => {
                    let mut changed = cameras.clone();
                    let (one, axis, number) = (bytes.below(CAMERAS), bytes.below(9), bytes.number());
                    match bytes.below(4) {
                        0 => changed[one].k[axis] *= number,
                        1 => changed[one].t[axis % 3] += number,
                        2 => changed[one].distortion[axis % 5] = number,
                        _ => changed[one].width = bytes.word(),
                    }
                    pcmvs_rig_set_cameras(rig, changed.as_ptr(), changed.len())
                }
                1 => {
                    left = bytes.below(64) as i32;
                    options.max_memory = u64::from(bytes.byte()) << 18;
                    pcmvs_frame_reconstruct(frame, views.as_ptr(), views.len(), &options)
                }
                2 => pcmvs_frame_begin(frame, &options),
                3..=5 => pcmvs_frame_view(frame, index, view),
                6 => pcmvs_frame_step(frame, bytes.below(10) as u32),
                7 => pcmvs_frame_detect(frame, index),
                8 => pcmvs_frame_colour(frame),
                9 => {
                    let mut mesh = MaybeUninit::uninit();
                    pcmvs_frame_get_mesh(frame, index, mesh.as_mut_ptr(), 56)
                }
                10 => pcmvs_frame_copy_cloud(frame, index, index, buffer.as_mut_ptr().cast(), 100, 0, &mut count),
                11 => {
                    let mut silhouette = MaybeUninit::uninit();
                    pcmvs_frame_get_silhouette(frame, index, silhouette.as_mut_ptr(), 16)
                }
                12 => {
                    let mut report = MaybeUninit::uninit();
                    pcmvs_frame_get_view_report(frame, index, report.as_mut_ptr(), 32)
                }
                13 => {
                    let mut counts = MaybeUninit::uninit();
                    pcmvs_frame_get_counts(frame, counts.as_mut_ptr(), 64)
                }
                14 => {
                    let (mut warnings, mut warning) = (0, MaybeUninit::uninit());
                    pcmvs_frame_warning_count(frame, &mut warnings);
                    pcmvs_frame_get_warning(frame, index, warning.as_mut_ptr(), 8 + 32 + 480)
                }
                15 => pcmvs_frame_export_mesh_to_buffer(
                    frame,
                    index,
                    null(),
                    buffer.as_mut_ptr().cast(),
                    buffer.len(),
                    &mut count,
                ),
                16 if place < 8 => {
                    let mut new = null_mut();
                    let status = pcmvs_frame_new(rig, &mut new);
                    if status == pcmvs_status::Ok {
                        ok(pcmvs_frame_free(frame));
                        (stale, frames[place % 2]) = (frame, new);
                    }
                    status
                }
                _ => {
                    for (i, view) in views.iter().enumerate() {
                        pcmvs_frame_view(frame, i as u32, view);
                    }
                    pcmvs_status::Ok
                }
            };
            assert_ne!(status, pcmvs_status::Panic);
        }
        frames.iter().for_each(|&frame| ok(pcmvs_frame_free(frame)));
        ok(pcmvs_rig_free(rig));
    }
});
