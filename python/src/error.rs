//! Exceptions. `pcmvs/errors.py` defines their classes, because some of them have two bases.

use pcmvs_core::{Error, ErrorCode};
use pcmvs_scene::Failure;
use pyo3::prelude::*;

/// What went wrong, on its way to an exception.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Name of the exception's class.
    class: &'static str,
    code: &'static str,
    camera: Option<u32>,
    message: String,
}

impl Problem {
    /// An argument that cannot be used.
    pub fn argument(message: impl Into<String>) -> Self {
        let code = ErrorCode::InvalidArgument.name();
        Self { class: "InputError", code, camera: None, message: message.into() }
    }

    /// The same problem, with the camera that it is about.
    pub fn of_camera(self, camera: usize) -> Self {
        Self { camera: Some(camera as u32), ..self }
    }
}

impl From<Error> for Problem {
    fn from(error: Error) -> Self {
        let class = match error.code() {
            ErrorCode::OutOfMemory => "MemoryLimitError",
            ErrorCode::WrongOrder => "OrderError",
            ErrorCode::Cancelled => "Cancelled",
            _ => "InputError",
        };
        Self { class, code: error.code().name(), camera: error.camera(), message: error.to_string() }
    }
}

impl From<Failure> for Problem {
    fn from(failure: Failure) -> Self {
        let message = failure.to_string();
        match failure {
            Failure::Input(_) => Self { class: "InputError", code: "scene", camera: None, message },
            Failure::Cancelled => Error::Cancelled.into(),
            Failure::Other(_) => Self { class: "Error", code: "other", camera: None, message },
        }
    }
}

impl From<Problem> for PyErr {
    fn from(problem: Problem) -> Self {
        let Problem { class, code, camera, message } = problem;
        Python::attach(|py| {
            let errors = py.import("pcmvs.errors");
            let made = errors.and_then(|errors| errors.getattr(class)?.call1((message, code, camera)));
            made.map_or_else(|failed| failed, PyErr::from_value)
        })
    }
}
