//! A whole tiny frame through C, without files and other programs, so that it can run under Miri:
//!
//! ```sh
//! cargo +nightly miri test -p pcmvs-ffi --features libm/force-soft-floats --test whole
//! ```
//!
//! It takes too long there for `cargo xtask miri`.

#![allow(unsafe_code, reason = "it calls the library as C does")]

use pcmvs::{
    camera::{pcmvs_camera, pcmvs_camera_init},
    export::pcmvs_frame_export_mesh,
    frame::{pcmvs_frame_free, pcmvs_frame_new, pcmvs_frame_reconstruct},
    image::{pcmvs_image, pcmvs_image_init, pcmvs_pixel_format},
    mesh::{pcmvs_frame_get_mesh, pcmvs_mesh},
    rig::{pcmvs_rig_free, pcmvs_rig_new, pcmvs_rig_set_cameras},
    status::pcmvs_status,
    view::{pcmvs_view, pcmvs_view_init},
};
use std::{
    collections::BTreeSet,
    ffi::{c_int, c_void},
    mem::MaybeUninit,
    ptr::{null, null_mut},
    slice,
};

const VIEWS: u32 = 6;
/// Width and height of the pictures.
const SIZE: u32 = 24;

/// A struct that a function of the library writes.
fn filled<T>(write: impl FnOnce(*mut T, usize) -> pcmvs_status) -> T {
    let mut value = MaybeUninit::zeroed();
    ok(write(value.as_mut_ptr(), size_of::<T>()));
    // SAFETY: all of it has been written.
    unsafe { value.assume_init() }
}

fn ok(status: pcmvs_status) {
    assert_eq!(status, pcmvs_status::Ok);
}

/// A camera at a distance of 3 from the zero of the scene, at which it looks: one of a ring in steps of 30 degrees.
fn camera(i: u32) -> pcmvs_camera {
    let (sin, cos) = libm::sincos(f64::from(i) * std::f64::consts::PI / 6.0);
    let (focal, middle) = (1.5 * f64::from(SIZE), 0.5 * f64::from(SIZE - 1));
    // SAFETY: the pointer and the size are those of the struct.
    let init = filled(|target, size| unsafe { pcmvs_camera_init(target, size) });
    pcmvs_camera {
        width: SIZE,
        height: SIZE,
        k: [focal, 0.0, middle, 0.0, focal, middle, 0.0, 0.0, 1.0],
        r: [-sin, cos, 0.0, 0.0, 0.0, -1.0, -cos, -sin, 0.0],
        t: [0.0, 0.0, 3.0],
        ..init
    }
}

/// A disc with a pattern on it, and its mask: a ball as every camera sees it.
fn disc(pixel: u32) -> (u8, u8) {
    let (x, y) = (2 * (pixel % SIZE) as i32 - SIZE as i32 + 1, 2 * (pixel / SIZE) as i32 - SIZE as i32 + 1);
    let pattern = (40 + 29 * (pixel % 7)) as u8;
    (pattern, if x * x + y * y < 320 { 255 } else { 0 })
}

fn image(pixels: &[u8]) -> pcmvs_image {
    // SAFETY: as above.
    let init = filled(|target, size| unsafe { pcmvs_image_init(target, size) });
    let format = pcmvs_pixel_format::Gray8 as u32;
    pcmvs_image { format, width: SIZE, height: SIZE, data: pixels.as_ptr().cast(), ..init }
}

unsafe extern "C" fn append(user: *mut c_void, data: *const c_void, size: usize) -> c_int {
    // SAFETY: `user` is the vector that the test gives, and the library promises `size` bytes.
    unsafe { (*user.cast::<Vec<u8>>()).extend_from_slice(slice::from_raw_parts(data.cast(), size)) };
    0
}

#[test]
fn a_tiny_frame_is_a_closed_mesh() {
    let (picture, mask): (Vec<u8>, Vec<u8>) = (0..SIZE * SIZE).map(disc).unzip();
    let (picture, mask) = (image(&picture), image(&mask));
    // SAFETY: as above.
    let init = || filled(|target, size| unsafe { pcmvs_view_init(target, size) });
    let view = |_| pcmvs_view { image: &raw const picture, mask: &raw const mask, ..init() };
    let views: Vec<pcmvs_view> = (0..VIEWS).map(view).collect();
    let cameras: Vec<pcmvs_camera> = (0..VIEWS).map(|i| camera(2 * i)).collect();
    let (mut rig, mut frame) = (null_mut(), null_mut());
    let mut file: Vec<u8> = Vec::new();
    // SAFETY: handles are valid until they are freed, and counts are those of the arrays. The mesh is read before the frame
    // is freed.
    unsafe {
        ok(pcmvs_rig_new(&raw mut rig));
        ok(pcmvs_rig_set_cameras(rig, cameras.as_ptr(), cameras.len()));
        ok(pcmvs_frame_new(rig, &raw mut frame));
        ok(pcmvs_rig_free(rig));
        ok(pcmvs_frame_reconstruct(frame, views.as_ptr(), views.len(), null()));
        let mesh: pcmvs_mesh = filled(|target, size| pcmvs_frame_get_mesh(frame, 0, target, size));
        let triangles: &[[u32; 3]] = slice::from_raw_parts(mesh.triangles.cast(), mesh.triangle_count as usize);
        let edges: BTreeSet<(u32, u32)> =
            triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
        assert!(edges.len() == 3 * triangles.len() && !edges.is_empty());
        assert!(edges.iter().all(|&(from, to)| edges.contains(&(to, from))), "the mesh is open");
        ok(pcmvs_frame_export_mesh(frame, 0, null(), Some(append), (&raw mut file).cast()));
        ok(pcmvs_frame_free(frame));
    }
    assert!(file.starts_with(b"glTF"));
}
