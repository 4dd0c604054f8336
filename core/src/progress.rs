//! How a stage tells its host how far it is, and how the host stops it.

use crate::error::{Error, Result};
use alloc::vec::Vec;

/// The stages of a reconstruction in the order in which they run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Stage {
    /// Undistortion and silhouettes, one step a view.
    Views = 0,
    /// Visual hull (§0).
    Hull = 1,
    /// Frontier and implicit points (§4.4).
    Contours = 2,
    /// The coarse pass of detection and meshing, where there is one.
    Coarse = 3,
    /// Point cloud detection (§4), one step a view.
    Detect = 4,
    /// Merging (§5).
    Merge = 5,
    /// Meshing (§6).
    Mesh = 6,
    /// Colours (§7).
    Colour = 7,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Stage; 8] =
        [Self::Views, Self::Hull, Self::Contours, Self::Coarse, Self::Detect, Self::Merge, Self::Mesh, Self::Colour];

    /// Name as used in reports and file names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Views => "views",
            Self::Hull => "hull",
            Self::Contours => "contours",
            Self::Coarse => "coarse",
            Self::Detect => "detect",
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

/// A part of a stage that itself consists of stages: their steps count as the outer stage's.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a> {
    pub of: &'a dyn Progress,
    pub stage: Stage,
    pub part: u32,
    pub parts: u32,
}

impl Progress for Part<'_> {
    fn step(&self, _: Stage, done: u32, total: u32) -> bool {
        // In thousandths of a part.
        let done = u64::from(done) * 1000 / u64::from(total.max(1));
        self.of.step(self.stage, self.part * 1000 + done as u32, self.parts * 1000)
    }
}

/// Reports a step and turns a refusal into [`Error::Cancelled`].
pub(crate) fn step(progress: &dyn Progress, stage: Stage, done: u32, total: u32) -> Result<()> {
    if progress.step(stage, done, total) { Ok(()) } else { Err(Error::Cancelled) }
}

/// Runs independent pieces of work, in any order and on any thread; the results come back in order.
pub trait Executor: Sync {
    /// `(0..count).map(|i| job(scratch, i))`. While it runs, a piece has a scratch for itself: one of `spare`, or a new
    /// one if they are all in use. All end up in `spare`. What a scratch holds does not change a result.
    fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T>;

    /// `(0..count).map(job)`.
    fn map<T: Send>(&self, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
        self.map_with(&mut Vec::<()>::new(), count, |(), i| job(i))
    }
}

/// Runs everything on the calling thread.
#[derive(Debug, Clone, Copy, Default)]
pub struct Serial;

impl Executor for Serial {
    fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        let mut scratch = spare.pop().unwrap_or_default();
        let results = (0..count).map(|i| job(&mut scratch, i)).collect();
        spare.push(scratch);
        results
    }
}
