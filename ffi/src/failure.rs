//! Failures on their way to the caller.

use crate::status::pcmvs_status;
use pcmvs_core::{Error, ErrorCode, Stage};
use std::{
    fmt,
    sync::{Mutex, PoisonError},
};

pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// Why a call fails.
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

    /// The same failure in a stage.
    pub fn at(self, stage: Stage) -> Self {
        Self { stage: Some(stage), ..self }
    }

    /// The same failure of a camera.
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
            ErrorCode::TooFewViews => pcmvs_status::TooFewViews,
            ErrorCode::InvalidArgument => pcmvs_status::InvalidArgument,
            ErrorCode::EmptyHull => pcmvs_status::EmptyHull,
            ErrorCode::NoSurface => pcmvs_status::NoSurface,
            ErrorCode::OutOfMemory => pcmvs_status::OutOfMemory,
            ErrorCode::WrongOrder => pcmvs_status::WrongOrder,
            ErrorCode::Cancelled => pcmvs_status::Cancelled,
            _ => pcmvs_status::Other,
        };
        // A host may use the index for an array of its own.
        let camera = error.camera().filter(|_| !matches!(error, Error::NoSuchCamera { .. }));
        Self { status, stage: None, camera, message: error.to_string() }
    }
}

/// A handle's last failure, and whether a panic has made the handle unusable.
#[derive(Debug, Default)]
pub(crate) struct LastFailure(Mutex<Option<Kept>>);

/// A failure that is kept, and the number of the frame if the handle is a frame.
#[derive(Debug, Clone)]
pub(crate) struct Kept {
    pub failure: Failure,
    pub frame: Option<u32>,
}

impl fmt::Display for Kept {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if let Some(frame) = self.frame {
            write!(f, "frame {frame}: ")?;
        }
        f.write_str(&self.failure.message)
    }
}

impl LastFailure {
    /// Keeps the failure of a result and returns its status.
    pub fn keep(&self, result: Result<()>, frame: Option<u32>) -> pcmvs_status {
        let Err(failure) = result else { return pcmvs_status::Ok };
        let status = failure.status;
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // A failure after a panic does not hide the panic.
        if !matches!(&*last, Some(kept) if kept.failure.status == pcmvs_status::Panic) {
            *last = Some(Kept { failure, frame });
        }
        status
    }

    /// Fails after a panic.
    pub fn check(&self) -> Result<()> {
        match &*self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(kept) if kept.failure.status == pcmvs_status::Panic => Err(kept.failure.clone()),
            _ => Ok(()),
        }
    }

    /// Reads the last failure, if there is one.
    pub fn read<T>(&self, read: impl FnOnce(Option<&Kept>) -> T) -> T {
        read(self.0.lock().unwrap_or_else(PoisonError::into_inner).as_ref())
    }
}
