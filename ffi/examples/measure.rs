//! Measures the overhead of the C ABI over the same call in Rust, and the longest time between two calls of the progress
//! callback. Usage: measure VIEWS WIDTH HEIGHT ROUNDS. Fails if the overhead is 1 % or more. Linux only.
//!
//! Times are processor times of this thread. The two calls alternate and change their order from round to round, and the
//! fastest round of each counts, so that other load on the machine matters little.
#![allow(unsafe_code, reason = "it calls the C ABI as a host would")]

#[path = "../tests/common/plain.rs"]
#[allow(dead_code, reason = "nothing is written")]
mod plain;

use pcmvs::{
    camera::{pcmvs_camera, pcmvs_camera_init},
    frame::{pcmvs_frame_free, pcmvs_frame_new, pcmvs_frame_reconstruct},
    image::{pcmvs_image, pcmvs_image_init},
    options::{pcmvs_options, pcmvs_options_init},
    pixel_format::pcmvs_pixel_format,
    rig::{pcmvs_rig_free, pcmvs_rig_new, pcmvs_rig_set_cameras},
    status::pcmvs_status,
    view::{pcmvs_view, pcmvs_view_init},
};
use pcmvs_core::{
    Mask, Params, Preset, Rig, Serial, Silent, ViewInput,
    frame::{ORDER, position},
    reconstruct,
};
use std::{
    env,
    ffi::{c_int, c_long, c_void},
    mem::{size_of, zeroed},
    process::ExitCode,
    ptr::{null, null_mut},
    time::Duration,
};

/// Longest time without a call of the progress callback, per stage.
struct Gaps {
    last: Duration,
    longest: [Duration; ORDER.len()],
}

unsafe extern "C" fn follow(gaps: *mut c_void, stage: u32, _: u32, _: u32) -> c_int {
    // SAFETY: `main` passes its own.
    let gaps = unsafe { &mut *gaps.cast::<Gaps>() };
    let place = ORDER.iter().position(|s| s.id() == stage).expect("a stage");
    let longest = &mut gaps.longest[place];
    *longest = (*longest).max(now() - gaps.last);
    gaps.last = now();
    0
}

/// Processor time of this thread.
fn now() -> Duration {
    const CLOCK_THREAD_CPUTIME_ID: c_int = 3;
    unsafe extern "C" {
        fn clock_gettime(clock: c_int, time: *mut [c_long; 2]) -> c_int;
    }
    let mut time = [0; 2];
    // SAFETY: on 64-bit Linux a timespec is two longs.
    assert_eq!(unsafe { clock_gettime(CLOCK_THREAD_CPUTIME_ID, &raw mut time) }, 0);
    Duration::new(time[0] as u64, time[1] as u32)
}

fn time(work: &mut dyn FnMut()) -> Duration {
    let start = now();
    work();
    now() - start
}

fn ok(status: pcmvs_status) {
    assert_eq!(status, pcmvs_status::Ok);
}

fn main() -> ExitCode {
    let numbers: Vec<u32> = env::args().skip(1).map(|a| a.parse().expect("a number")).collect();
    let &[views, width, height, rounds] = &numbers[..] else { panic!("usage: measure VIEWS WIDTH HEIGHT ROUNDS") };
    let capture = plain::capture(views, width, height);
    let frame = &capture.frames[0];
    let inputs: Vec<ViewInput> = (0..views as usize)
        .map(|i| ViewInput { image: frame.images[i].as_ref(), mask: frame.mask(i).map_or(Mask::Unknown, Mask::Given) })
        .collect();
    let core_rig = Rig::new(&capture.cameras).unwrap();
    let params = Params::preset(Preset::Default);

    // SAFETY: each struct is initialised by its function, as in C, and everything outlives the calls.
    unsafe {
        let mut cameras = vec![zeroed::<pcmvs_camera>(); views as usize];
        for (c, camera) in cameras.iter_mut().zip(&capture.cameras) {
            ok(pcmvs_camera_init(c, size_of::<pcmvs_camera>()));
            (c.width, c.height, c.t) = (camera.width, camera.height, camera.t);
            c.distortion.copy_from_slice(&camera.lens.coefficients()[..5]);
            c.k.copy_from_slice(camera.k.as_flattened());
            c.r.copy_from_slice(camera.r.as_flattened());
        }
        let mut images = vec![zeroed::<pcmvs_image>(); 2 * views as usize];
        let mut c_views = vec![zeroed::<pcmvs_view>(); views as usize];
        for i in 0..views as usize {
            let mask = frame.masks[i].as_ref().unwrap();
            let formats = [pcmvs_pixel_format::Rgb8, pcmvs_pixel_format::Gray8];
            for (k, data) in [frame.images[i].rgb.as_ptr(), mask.as_ptr()].into_iter().enumerate() {
                let image = &mut images[2 * i + k];
                ok(pcmvs_image_init(image, size_of::<pcmvs_image>()));
                (image.width, image.height, image.data, image.format) = (width, height, data.cast(), formats[k] as u32);
            }
            ok(pcmvs_view_init(&mut c_views[i], size_of::<pcmvs_view>()));
            (c_views[i].image, c_views[i].mask) = (&raw const images[2 * i], &raw const images[2 * i + 1]);
        }
        let (mut rig, mut handle) = (null_mut(), null_mut());
        ok(pcmvs_rig_new(&mut rig));
        ok(pcmvs_rig_set_cameras(rig, cameras.as_ptr(), cameras.len()));
        ok(pcmvs_frame_new(rig, &mut handle));

        let mut gaps = Gaps { last: now(), longest: [Duration::ZERO; ORDER.len()] };
        let mut options = zeroed::<pcmvs_options>();
        ok(pcmvs_options_init(&mut options, size_of::<pcmvs_options>()));
        options.progress = Some(follow);
        options.progress_user = (&raw mut gaps).cast();
        let mut by_rust = || drop(reconstruct(&core_rig, &inputs, &params, &Serial, &Silent).unwrap());
        let mut by_c = || ok(pcmvs_frame_reconstruct(handle, c_views.as_ptr(), c_views.len(), null()));
        let mut times = Vec::new();
        for round in 0..rounds {
            times.push(if round % 2 == 0 {
                let rust = time(&mut by_rust);
                (rust, time(&mut by_c))
            } else {
                let c = time(&mut by_c);
                (time(&mut by_rust), c)
            });
        }
        gaps.last = now();
        ok(pcmvs_frame_reconstruct(handle, c_views.as_ptr(), c_views.len(), &options));
        ok(pcmvs_frame_free(handle));
        ok(pcmvs_rig_free(rig));
        let cost = |rust: Duration, c: Duration| (c.as_secs_f64() / rust.as_secs_f64() - 1.0) * 100.0;
        let rust = times.iter().map(|t| t.0).min().expect("a round");
        let c = times.iter().map(|t| t.1).min().expect("a round");
        let mut costs: Vec<f64> = times.iter().map(|&(rust, c)| cost(rust, c)).collect();
        costs.sort_by(f64::total_cmp);
        let (fastest, median) = (cost(rust, c), costs[costs.len() / 2]);
        println!("Rust {rust:.3?}, C {c:.3?}: {fastest:+.2} %, median of {rounds} rounds {median:+.2} %");
        for stage in ORDER {
            println!("{:8} longest time without a progress call {:.1?}", stage.name(), gaps.longest[position(stage)]);
        }
        if fastest < 1.0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}
