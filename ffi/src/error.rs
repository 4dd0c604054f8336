//! Why a call failed.

use crate::{boundary::Growing, status::pcmvs_status};
use pcmvs_core::{Error, ErrorCode, Stage};
use std::{
    ffi::c_char,
    sync::{Mutex, PoisonError},
};

/// Bytes of an error's message, with its final zero.
pub const PCMVS_MESSAGE_SIZE: usize = 480;

/// Why the last call on a handle that failed did so.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_error {
    /// What the call returned, a `pcmvs_status`; `PCMVS_STATUS_OK` if none has failed yet.
    pub status: u32,
    /// The stage in which it failed, or whose result was asked for, a `pcmvs_stage`; -1 if none.
    pub stage: i32,
    /// Index of the camera that is to blame; -1 if none.
    pub camera: i32,
    /// Zero.
    pub reserved: i32,
    /// Number of the frame as in `pcmvs_options`; -1 for a rig.
    pub frame: i64,
    /// What is wrong and what to do, in English, UTF-8, ended by a zero.
    pub message: [c_char; PCMVS_MESSAGE_SIZE],
}

impl Growing for pcmvs_error {
    const FIRST_SIZE: usize = 24 + PCMVS_MESSAGE_SIZE;
}

/// A failure on its way to the caller.
#[derive(Debug, Clone)]
pub(crate) struct Failure {
    pub status: pcmvs_status,
    pub stage: Option<Stage>,
    pub camera: Option<u32>,
    pub message: String,
}

impl Failure {
    pub fn new(status: pcmvs_status, message: impl Into<String>) -> Self {
        Self { status, stage: None, camera: None, message: message.into() }
    }

    pub fn panic(message: &str) -> Self {
        Self::new(pcmvs_status::Panic, format!("{message}: this is a bug in pcmvs, please report it"))
    }

    /// The same, known to be a stage's.
    pub fn at(self, stage: Stage) -> Self {
        Self { stage: Some(stage), ..self }
    }

    /// The same, known to be a camera's.
    pub fn of_camera(self, camera: u32) -> Self {
        Self { camera: Some(camera), ..self }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let status = match error.code() {
            ErrorCode::Camera => pcmvs_status::Camera,
            ErrorCode::Image => pcmvs_status::Image,
            ErrorCode::Silhouette => pcmvs_status::Silhouette,
            ErrorCode::DuplicateCamera => pcmvs_status::DuplicateCamera,
            ErrorCode::TooFewViews => pcmvs_status::TooFewViews,
            ErrorCode::InvalidArgument => pcmvs_status::InvalidArgument,
            ErrorCode::EmptyHull => pcmvs_status::EmptyHull,
            ErrorCode::NoSurface => pcmvs_status::NoSurface,
            ErrorCode::OutOfMemory => pcmvs_status::OutOfMemory,
            ErrorCode::WrongOrder => pcmvs_status::WrongOrder,
            ErrorCode::Cancelled => pcmvs_status::Cancelled,
            _ => pcmvs_status::Other,
        };
        Self { status, stage: None, camera: error.camera(), message: error.to_string() }
    }
}

/// A handle's last failure, and whether a panic has made it unusable.
#[derive(Debug, Default)]
pub(crate) struct LastFailure(Mutex<Option<(Failure, Option<u32>)>>);

impl LastFailure {
    /// Keeps a result's failure and gives its number. `frame` is the frame's number, if it is a frame's.
    pub fn keep(&self, result: Result<(), Failure>, frame: Option<u32>) -> pcmvs_status {
        let Err(failure) = result else { return pcmvs_status::Ok };
        let status = failure.status;
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // What follows a panic does not hide it.
        if !matches!(&*kept, Some((f, _)) if f.status == pcmvs_status::Panic) {
            *kept = Some((failure, frame));
        }
        status
    }

    /// Fails once a panic has passed.
    pub fn check(&self) -> Result<(), Failure> {
        match &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some((failure, _)) if failure.status == pcmvs_status::Panic => Err(failure.clone()),
            _ => Ok(()),
        }
    }

    /// The failure as C sees it.
    pub fn get(&self) -> pcmvs_error {
        let mut error =
            pcmvs_error { status: 0, stage: -1, camera: -1, reserved: 0, frame: -1, message: [0; PCMVS_MESSAGE_SIZE] };
        if let Some((failure, frame)) = &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            error.status = failure.status as u32;
            error.stage = failure.stage.map_or(-1, |stage| stage.id() as i32);
            error.camera = failure.camera.map_or(-1, |c| c as i32);
            error.frame = frame.map_or(-1, i64::from);
            let place = frame.map_or_else(String::new, |f| format!("frame {f}: "));
            let text = format!("{place}{}", failure.message);
            let end =
                (0..PCMVS_MESSAGE_SIZE.min(text.len() + 1)).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0);
            for (to, from) in error.message.iter_mut().zip(&text.as_bytes()[..end]) {
                *to = *from as c_char;
            }
        }
        error
    }
}
