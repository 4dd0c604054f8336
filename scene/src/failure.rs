//! Errors of runs and imports.

use std::{fmt, io, path::Path};

/// Why a run, a frame or an import could not be finished.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// The usage or the input is wrong. The message names file, camera and remedy.
    Input(String),
    /// The user asked to stop.
    Cancelled,
    /// Anything else, such as a full disk, too little memory or an internal error.
    Other(String),
}

impl Failure {
    /// An input file that cannot be read.
    pub fn unreadable(path: &Path, error: &io::Error) -> Self {
        Self::Input(format!("{}: cannot be read ({error}): check that the file is there and readable", path.display()))
    }

    /// An output file that cannot be written.
    pub fn unwritable(path: &Path, error: &io::Error) -> Self {
        Self::Other(format!("{}: cannot be written ({error}): check free space and permissions", path.display()))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(message) | Self::Other(message) => f.write_str(message),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}
