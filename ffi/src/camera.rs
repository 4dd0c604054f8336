//! Calibrated cameras.

use crate::{
    sized::{Growing, Versioned, init},
    status::pcmvs_status,
};
use pcmvs_core::{Camera, Lens};
use std::mem::size_of;

/// Models of a lens. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_lens {
    /// OpenCV's k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4.
    Opencv = 0,
    /// OpenCV's fisheye, which is equidistant: k1, k2, k3, k4.
    Fisheye = 1,
}

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
    /// Distortion coefficients as in OpenCV: k1, k2, p1, p2, k3. Of a fisheye k1, k2, k3, k4, and then 0.
    pub distortion: [f64; 5],
    /// Rotation R from the scene's to the camera's frame.
    pub r: [f64; 9],
    /// Translation t from the scene's to the camera's frame, in the scene's unit.
    pub t: [f64; 3],
    /// A `pcmvs_lens`: the model that the distortion coefficients belong to.
    pub lens: u32,
    /// Zero.
    pub reserved_lens: u32,
    /// `PCMVS_LENS_OPENCV`: further distortion coefficients k4, k5, k6, s1, s2, s3, s4 of the rational model and the thin
    /// prism. Otherwise zero.
    pub distortion_more: [f64; 7],
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
            lens: pcmvs_lens::Opencv as u32,
            reserved_lens: 0,
            distortion_more: [0.0; 7],
        }
    }

    fn reserved_is_zero(&self) -> bool {
        self.reserved == 0 && self.reserved_lens == 0
    }
}

impl pcmvs_camera {
    /// The camera as the core takes it. The error says what is wrong with its lens.
    pub(crate) fn to_core(self) -> Result<Camera, String> {
        let rows = |m: [f64; 9]| [0, 1, 2].map(|r| [m[3 * r], m[3 * r + 1], m[3 * r + 2]]);
        let Self { width, height, k, r, t, .. } = self;
        Ok(Camera { width, height, k: rows(k), lens: self.core_lens()?, r: rows(r), t })
    }

    fn core_lens(&self) -> Result<Lens, String> {
        let Self { lens, distortion: [k1, k2, p1, p2, k3], distortion_more: more, .. } = *self;
        if lens == pcmvs_lens::Opencv as u32 {
            let [k4, k5, k6, s1, s2, s3, s4] = more;
            Ok(Lens::OpenCv([k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4]))
        } else if lens == pcmvs_lens::Fisheye as u32 {
            if k3 != 0.0 || more != [0.0; 7] {
                return Err(String::from("a fisheye has four coefficients: set the others to zero"));
            }
            Ok(Lens::Fisheye([k1, k2, p1, p2]))
        } else {
            Err(format!("its lens is {lens}: set a value of pcmvs_lens"))
        }
    }

    pub(crate) fn from_core(camera: &Camera) -> Self {
        let list = |m: [[f64; 3]; 3]| [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i| m[i / 3][i % 3]);
        let Camera { width, height, k, lens, r, t } = *camera;
        let plain = Self { width, height, k: list(k), r: list(r), t, ..Self::defaults() };
        match lens {
            Lens::OpenCv([k1, k2, p1, p2, k3, more @ ..]) => {
                Self { distortion: [k1, k2, p1, p2, k3], distortion_more: more, ..plain }
            }
            Lens::Fisheye([k1, k2, k3, k4]) => {
                Self { lens: pcmvs_lens::Fisheye as u32, distortion: [k1, k2, k3, k4, 0.0], ..plain }
            }
        }
    }
}

/// Initialises a camera with identity matrices and no distortion. `size` is `sizeof *camera`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_camera_init(camera: *mut pcmvs_camera, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(camera, size, "camera") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lenses_come_back() {
        let fisheye = Lens::Fisheye([0.1, 0.2, 0.3, 0.4]);
        for lens in [Lens::NONE, Lens::OpenCv(std::array::from_fn(|i| i as f64 + 0.5)), fisheye] {
            let camera = Camera { lens, ..pcmvs_camera::defaults().to_core().unwrap() };
            assert_eq!(pcmvs_camera::from_core(&camera).to_core(), Ok(camera));
        }
    }

    #[test]
    fn lenses_that_do_not_exist_are_refused() {
        let of = |lens: pcmvs_lens| pcmvs_camera { lens: lens as u32, ..pcmvs_camera::defaults() };
        assert!(pcmvs_camera { lens: 2, ..pcmvs_camera::defaults() }.to_core().unwrap_err().contains("pcmvs_lens"));
        let mut fifth = of(pcmvs_lens::Fisheye);
        fifth.distortion[4] = 0.1;
        assert!(fifth.to_core().unwrap_err().contains("four"));
        let mut more = of(pcmvs_lens::Fisheye);
        more.distortion_more[6] = 0.1;
        assert!(more.to_core().unwrap_err().contains("four"));
    }
}
