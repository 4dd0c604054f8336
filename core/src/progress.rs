//! How stages report progress to the host, and how the host cancels them.

use crate::{
    error::{Error, Result},
    stage::Stage,
};
use core::sync::atomic::{AtomicU32, Ordering};

/// Receives progress reports. Called on the thread that does the work: with a multi-threaded [`crate::Executor`], on
/// several threads at the same time.
pub trait Progress: Sync {
    /// A stage starts.
    fn on_stage_start(&self, stage: Stage) {
        let _ = stage;
    }
    /// A stage has ended, whether it succeeded or not.
    fn on_stage_end(&self, stage: Stage) {
        let _ = stage;
    }
    /// `done` of the `total` steps of a stage are complete. Return false to cancel.
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

/// Reports an inner stage as one of the `parts` of an outer stage. Used where a stage runs other stages.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a> {
    pub of: &'a dyn Progress,
    pub stage: Stage,
    pub part: u32,
    pub parts: u32,
}

impl Progress for Part<'_> {
    fn step(&self, _: Stage, done: u32, total: u32) -> bool {
        // Counted in thousandths of a part.
        let done = u64::from(done) * 1000 / u64::from(total.max(1));
        self.of.step(self.stage, self.part * 1000 + done as u32, self.parts * 1000)
    }
}

/// Reports steps of work that may be done again, such as carving without a view that turned out to be wrong: the share that is
/// done never falls.
pub(crate) struct Onward<'a> {
    of: &'a dyn Progress,
    /// The largest share so far, in parts of [`Self::WHOLE`].
    done: AtomicU32,
}

impl<'a> Onward<'a> {
    const WHOLE: u32 = 1 << 16;

    /// Nothing is done.
    pub fn new(of: &'a dyn Progress) -> Self {
        Self { of, done: AtomicU32::new(0) }
    }
}

impl Progress for Onward<'_> {
    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        let share = u64::from(done.min(total)) * u64::from(Self::WHOLE) / u64::from(total.max(1));
        let before = self.done.fetch_max(share as u32, Ordering::Relaxed);
        self.of.step(stage, before.max(share as u32), Self::WHOLE)
    }
}

/// Reports a step. Returns [`Error::Cancelled`] if the host cancels.
pub(crate) fn step(progress: &dyn Progress, stage: Stage, done: u32, total: u32) -> Result<()> {
    if progress.step(stage, done, total) { Ok(()) } else { Err(Error::Cancelled) }
}
