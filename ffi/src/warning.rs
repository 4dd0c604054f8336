//! Warnings, and those of a frame.

use crate::{
    boundary::out,
    error::PCMVS_MESSAGE_SIZE,
    failure::Failure,
    frame::{pcmvs_frame, shared},
    sized::{Growing, write},
    status::pcmvs_status::{self, InvalidArgument},
    text::text,
    work::Work,
};
use std::ffi::c_char;

/// Size of a warning's code in bytes, with its final zero.
pub const PCMVS_CODE_SIZE: usize = 32;

/// Something in a frame that may make its result worse although no call failed, or something wrong with a calibration.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_warning {
    /// Index of the camera that the warning is about, of the later one if it is about two. -1 if it is not about one or
    /// two cameras.
    pub camera: i32,
    /// Zero.
    pub reserved: u32,
    /// The kind of warning, such as "no-silhouette" or "no-stereo-points". A code never changes; later versions may add
    /// codes. ASCII with a final zero.
    pub code: [c_char; PCMVS_CODE_SIZE],
    /// What is wrong and what to do about it, in English. UTF-8 with a final zero.
    pub message: [c_char; PCMVS_MESSAGE_SIZE],
}

impl Growing for pcmvs_warning {
    const FIRST_SIZE: usize = 8 + PCMVS_CODE_SIZE + PCMVS_MESSAGE_SIZE;
}

/// Returns the number of warnings about the cameras and about the stages that are complete. After a stage has failed, the
/// warnings about the views remain.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_warning_count(frame: *const pcmvs_frame, count: *mut u32) -> pcmvs_status {
    let get = |work: &Work| {
        let count = out(count, "count")?;
        // SAFETY: the caller's promise.
        unsafe { count.write(work.frame.warnings().len() as u32) };
        Ok(())
    };
    shared(frame, get)
}

/// Returns a warning. `index` is less than `pcmvs_frame_warning_count`; warnings about the cameras come first, then those of
/// the stages in their order, and for each stage those of the cameras in theirs. `size` is `sizeof *warning`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_get_warning(
    frame: *const pcmvs_frame,
    index: u32,
    warning: *mut pcmvs_warning,
    size: usize,
) -> pcmvs_status {
    let get = |work: &Work| {
        let warnings = work.frame.warnings();
        let count = warnings.len();
        let found = warnings.into_iter().nth(index as usize).ok_or_else(|| {
            Failure::new(InvalidArgument, format!("there is no warning {index}: the frame has {count}"))
        })?;
        let found = pcmvs_warning {
            camera: found.camera().map_or(-1, |camera| camera as i32),
            reserved: 0,
            code: text(found.code()),
            message: text(&found),
        };
        // SAFETY: the caller's promise.
        unsafe { write(warning, size, &found, "warning") }
    };
    shared(frame, get)
}
