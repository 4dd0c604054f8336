//! How a stage tells its host how far it is, and how the host stops it.

use crate::error::{Error, Result};

/// The stages of a reconstruction in the order in which they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Stage {
    /// Undistortion and silhouettes, one step a view.
    Views = 0,
    /// Visual hull (§0).
    Hull = 1,
    /// Point cloud detection (§4), one step a view.
    Detect = 2,
    /// Frontier and implicit points (§4.4).
    Contours = 3,
    /// Merging (§5).
    Merge = 4,
    /// Meshing (§6).
    Mesh = 5,
    /// Colours (§7).
    Colour = 6,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 7] =
        [Self::Views, Self::Hull, Self::Detect, Self::Contours, Self::Merge, Self::Mesh, Self::Colour];

    /// Name as used in reports and file names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Views => "views",
            Self::Hull => "hull",
            Self::Detect => "detect",
            Self::Contours => "contours",
            Self::Merge => "merge",
            Self::Mesh => "mesh",
            Self::Colour => "colour",
        }
    }
}

/// Receives progress. Called on the thread that runs the stage; with an [`crate::Executor`] that uses threads,
/// from several of them.
pub trait Progress: Sync {
    /// A stage starts (`begin`) or has ended.
    fn mark(&self, stage: Stage, begin: bool) {
        let _ = (stage, begin);
    }
    /// Work of a stage has advanced by `done` out of `total`; return false to cancel.
    fn step(&self, stage: Stage, done: u32, total: u32) -> bool;
}

/// Ignores progress and never cancels.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;

impl Progress for Silent {
    fn step(&self, _: Stage, _: u32, _: u32) -> bool {
        true
    }
}

/// Reports a step and turns a refusal into [`Error::Cancelled`].
pub(crate) fn step(progress: &dyn Progress, stage: Stage, done: u32, total: u32) -> Result<()> {
    if progress.step(stage, done, total) { Ok(()) } else { Err(Error::Cancelled) }
}

/// Runs independent pieces of work, in any order and on any thread; the results come back in order.
pub trait Executor: Sync {
    /// `(0..count).map(job)`.
    fn map<T: Send>(&self, count: usize, job: impl Fn(usize) -> T + Sync) -> alloc::vec::Vec<T>;
}

/// Runs everything on the calling thread.
#[derive(Debug, Clone, Copy, Default)]
pub struct Serial;

impl Executor for Serial {
    fn map<T: Send>(&self, count: usize, job: impl Fn(usize) -> T + Sync) -> alloc::vec::Vec<T> {
        (0..count).map(job).collect()
    }
}
