//! The last failure of a handle, as C reads it.

use crate::{
    failure::{Kept, LastFailure},
    sized::Growing,
    text::text,
};
use std::ffi::c_char;

/// Size of an error's or warning's message in bytes, with its final zero.
pub const PCMVS_MESSAGE_SIZE: usize = 480;

/// Describes the last failed call on a handle.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_error {
    /// What the call returned, a `pcmvs_status`. `PCMVS_STATUS_OK` if no call has failed yet.
    pub status: u32,
    /// The stage that failed or whose result was asked for, a `pcmvs_stage`. -1 if the failure belongs to no stage.
    pub stage: i32,
    /// Index of the camera to blame. -1 if it is not known or there is none.
    pub camera: i32,
    /// Zero.
    pub reserved: i32,
    /// Number of the frame, as given in `pcmvs_options`. For a calibration, the number of frames that were added before the
    /// one at fault. -1 for a rig, and if the failure belongs to no frame.
    pub frame: i64,
    /// What is wrong and what to do about it, in English. UTF-8 with a final zero.
    pub message: [c_char; PCMVS_MESSAGE_SIZE],
}

impl Growing for pcmvs_error {
    const FIRST_SIZE: usize = 24 + PCMVS_MESSAGE_SIZE;
}

impl From<&LastFailure> for pcmvs_error {
    fn from(last: &LastFailure) -> Self {
        last.read(|kept| kept.map_or(Self::NONE, Self::of))
    }
}

impl pcmvs_error {
    const NONE: Self =
        Self { status: 0, stage: -1, camera: -1, reserved: 0, frame: -1, message: [0; PCMVS_MESSAGE_SIZE] };

    fn of(kept: &Kept) -> Self {
        let failure = &kept.failure;
        Self {
            status: failure.status as u32,
            stage: failure.stage.map_or(-1, |stage| stage.id() as i32),
            camera: failure.camera.map_or(-1, |camera| camera as i32),
            reserved: 0,
            frame: kept.frame.map_or(-1, i64::from),
            message: text(kept),
        }
    }
}
