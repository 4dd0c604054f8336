//! How a calibration is checked and refined.

use crate::{
    clock::Clock,
    executor::{HostThreads, pcmvs_parallel_fn},
    failure::{Failure, Result},
    progress::{HostProgress, pcmvs_progress_fn},
    sized::{Growing, Versioned, init},
    status::pcmvs_status::{self, InvalidArgument},
};
use pcmvs_core::calibration::CalibrationParams;
use std::{ffi::c_void, mem::size_of, ptr::null_mut};

/// Options for a calibration. If every member but `struct_size` is zero, these are the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_calibration_options {
    /// Set by `pcmvs_calibration_options_init`.
    pub struct_size: u32,
    /// 1 to refine focal lengths and principal points too, 0 to keep them. Rings of few cameras determine them weakly.
    pub intrinsics: u32,
    /// Called as the work advances, with `PCMVS_STAGE_VIEWS` while views are read and `PCMVS_STAGE_DETECT` while the cameras
    /// are refined. May be NULL.
    pub progress: pcmvs_progress_fn,
    /// Passed to `progress`.
    pub progress_user: *mut c_void,
    /// Runs jobs on the caller's threads. If it is NULL, all work runs on the calling thread.
    pub parallel: pcmvs_parallel_fn,
    /// Passed to `parallel`.
    pub parallel_user: *mut c_void,
}

impl Growing for pcmvs_calibration_options {
    const FIRST_SIZE: usize = 8 + 4 * size_of::<usize>();
}

// SAFETY: numbers, raw pointers and nullable function pointers, the size first, no padding.
unsafe impl Versioned for pcmvs_calibration_options {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            intrinsics: 0,
            progress: None,
            progress_user: null_mut(),
            parallel: None,
            parallel_user: null_mut(),
        }
    }
}

/// Initialises options with their defaults. `size` is `sizeof *options`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_calibration_options_init(
    options: *mut pcmvs_calibration_options,
    size: usize,
) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(options, size, "options") }
}

impl pcmvs_calibration_options {
    pub(crate) fn params(&self) -> Result<CalibrationParams> {
        if self.intrinsics > 1 {
            return Err(Failure::new(InvalidArgument, format!("intrinsics is {}: it must be 0 or 1", self.intrinsics)));
        }
        Ok(CalibrationParams { intrinsics: self.intrinsics == 1, ..CalibrationParams::default() })
    }

    pub(crate) fn threads(&self) -> HostThreads {
        HostThreads { parallel: self.parallel, user: self.parallel_user }
    }

    /// Progress of one call on the current thread.
    pub(crate) fn progress<'a>(&self, clock: &'a Clock) -> HostProgress<'a> {
        HostProgress::new(clock, self.progress, self.progress_user, self.parallel.is_some())
    }
}
