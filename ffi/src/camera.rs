//! Calibrated cameras.

use crate::{
    sized::{Growing, Versioned, init},
    status::pcmvs_status,
};
use pcmvs_core::Camera;
use std::mem::size_of;

/// A calibrated camera in OpenCV's convention. A point X of the scene projects to the pixel `K * distort(R X + t)`. In the
/// camera's frame x points right, y down and z forward. The centre of the first pixel is (0, 0). Matrices are stored row
/// by row.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_camera {
    /// Set by `pcmvs_camera_init`.
    pub struct_size: u32,
    /// Width of the camera's pictures in pixels.
    pub width: u32,
    /// Height of the camera's pictures in pixels.
    pub height: u32,
    /// Zero.
    pub reserved: u32,
    /// Intrinsic matrix K in pixels. The last row is 0 0 1. Skew is allowed.
    pub k: [f64; 9],
    /// Distortion coefficients k1, k2, p1, p2, k3 as in OpenCV.
    pub distortion: [f64; 5],
    /// Rotation R from the scene's to the camera's frame.
    pub r: [f64; 9],
    /// Translation t from the scene's to the camera's frame, in the scene's unit.
    pub t: [f64; 3],
}

impl Growing for pcmvs_camera {
    const FIRST_SIZE: usize = 224;
}

// SAFETY: numbers only, the size first, no padding.
unsafe impl Versioned for pcmvs_camera {
    fn defaults() -> Self {
        let identity = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        Self {
            struct_size: size_of::<Self>() as u32,
            width: 0,
            height: 0,
            reserved: 0,
            k: identity,
            distortion: [0.0; 5],
            r: identity,
            t: [0.0; 3],
        }
    }

    fn reserved_is_zero(&self) -> bool {
        self.reserved == 0
    }
}

impl pcmvs_camera {
    pub(crate) fn to_core(self) -> Camera {
        let rows = |m: [f64; 9]| [0, 1, 2].map(|r| [m[3 * r], m[3 * r + 1], m[3 * r + 2]]);
        let Self { width, height, k, distortion, r, t, .. } = self;
        Camera { width, height, k: rows(k), distortion, r: rows(r), t }
    }

    pub(crate) fn from_core(camera: &Camera) -> Self {
        let list = |m: [[f64; 3]; 3]| [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i| m[i / 3][i % 3]);
        let Camera { width, height, k, distortion, r, t } = *camera;
        Self { width, height, k: list(k), distortion, r: list(r), t, ..Self::defaults() }
    }
}

/// Initialises a camera with identity matrices and no distortion. `size` is `sizeof *camera`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_camera_init(camera: *mut pcmvs_camera, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(camera, size, "camera") }
}
