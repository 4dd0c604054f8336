//! Structs of the C library.

use pcmvs::{
    camera::{pcmvs_camera, pcmvs_camera_init},
    status::pcmvs_status,
};
use pcmvs_core::Camera;
use std::mem::MaybeUninit;

/// A struct as its function of the library initialises it.
pub fn init<T>(init: unsafe extern "C" fn(*mut T, usize) -> pcmvs_status) -> T {
    let mut value = MaybeUninit::<T>::zeroed();
    // SAFETY: the function writes the struct.
    unsafe {
        assert_eq!(init(value.as_mut_ptr(), size_of::<T>()), pcmvs_status::Ok);
        value.assume_init()
    }
}

/// A camera without a lens for the library.
pub fn camera(c: &Camera) -> pcmvs_camera {
    pcmvs_camera {
        width: c.width,
        height: c.height,
        k: c.k.as_flattened().try_into().expect("three rows of three"),
        r: c.r.as_flattened().try_into().expect("three rows of three"),
        t: c.t,
        ..init(pcmvs_camera_init)
    }
}
