//! Picture files, and descriptions of pictures in memory as C programs give them.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pcmvs::{
    camera::pcmvs_camera,
    frame::{pcmvs_frame_begin, pcmvs_frame_free, pcmvs_frame_new, pcmvs_frame_view},
    image::{pcmvs_image, pcmvs_image_init},
    rig::{pcmvs_rig_free, pcmvs_rig_new, pcmvs_rig_set_cameras},
    status::pcmvs_status,
    view::{pcmvs_chroma_key, pcmvs_chroma_key_init, pcmvs_view, pcmvs_view_init},
};
use pcmvs_fuzz::{Bytes, camera, init, ring};
use pcmvs_scene::Picture;
use std::ptr::{null, null_mut};

const SIZE: u32 = 16;
/// Bytes of every plane, of which descriptions begin in the middle: enough for any stride that is tried.
const PLANE: usize = 1 << 16;

/// A description with room behind it, so that it has as many bytes as any `struct_size` says.
#[repr(C)]
struct Roomy {
    image: pcmvs_image,
    room: [u8; 256],
}

fn image(bytes: &mut Bytes, plane: &[u8]) -> Roomy {
    let mut image = init(pcmvs_image_init);
    let stride = |bytes: &mut Bytes| match bytes.below(4) {
        0 => 0,
        1 => isize::from(bytes.byte() as i8),
        2 => -isize::from(bytes.byte()) * 4,
        _ => isize::from(bytes.byte()) * 4,
    };
    image.format = bytes.below(9) as u32;
    (image.width, image.height) = (SIZE, SIZE);
    if bytes.below(8) == 0 {
        image.width = bytes.word();
        image.height = if bytes.below(2) == 0 { bytes.word() } else { SIZE };
    }
    (image.stride, image.chroma_stride) = (stride(bytes), stride(bytes));
    let middle = plane[PLANE / 2..].as_ptr().cast();
    image.data = if bytes.below(16) == 0 { null() } else { middle };
    image.chroma = if bytes.below(16) == 0 { null() } else { middle };
    if bytes.below(16) == 0 {
        image.struct_size = u32::from(bytes.byte());
    }
    let mut room = [0; 256];
    room[usize::from(bytes.byte())] = u8::from(bytes.below(16) == 0);
    Roomy { image, room }
}

fn description(bytes: &mut Bytes) {
    let plane: Vec<u8> = (0..PLANE).map(|i| (i * 7 + i / 251) as u8).collect();
    let images = [image(bytes, &plane), image(bytes, &plane)];
    let mut key: pcmvs_chroma_key = init(pcmvs_chroma_key_init);
    (key.tolerance, key.darkest_shadow) = (bytes.number() as f32, bytes.number() as f32);
    let mut view: pcmvs_view = init(pcmvs_view_init);
    view.image = if bytes.below(16) == 0 { null() } else { (&raw const images[0]).cast() };
    match bytes.below(5) {
        0 => {}
        1 => view.clean_plate = (&raw const images[1]).cast(),
        2 => view.chroma_key = &key,
        _ => view.mask = (&raw const images[1]).cast(),
    }
    view.reserved = u32::from(bytes.below(32) == 31);
    let mut cameras: Vec<pcmvs_camera> = ring(3, SIZE).iter().map(camera).collect();
    cameras[0].distortion[0] = 0.1;
    let (mut rig, mut frame) = (null_mut(), null_mut());
    // SAFETY: the structs hold what they say; strides stay within the plane.
    unsafe {
        assert_eq!(pcmvs_rig_new(&mut rig), pcmvs_status::Ok);
        assert_eq!(pcmvs_rig_set_cameras(rig, cameras.as_ptr(), cameras.len()), pcmvs_status::Ok);
        assert_eq!(pcmvs_frame_new(rig, &mut frame), pcmvs_status::Ok);
        assert_eq!(pcmvs_frame_begin(frame, null()), pcmvs_status::Ok);
        for camera in 0..2 {
            assert_ne!(pcmvs_frame_view(frame, camera, &view), pcmvs_status::Panic);
        }
        assert_eq!(pcmvs_frame_free(frame), pcmvs_status::Ok);
        assert_eq!(pcmvs_rig_free(rig), pcmvs_status::Ok);
    }
}

fuzz_target!(|bytes: &[u8]| {
    if bytes.starts_with(b"\x89PNG") || bytes.starts_with(b"\xFF\xD8") {
        if let Ok(picture) = Picture::decode(bytes) {
            assert_eq!(picture.view().check(), Ok(()));
        }
    } else {
        description(&mut Bytes(bytes));
    }
});
