//! Runs work of the core on threads of its own, while the calling thread passes progress on and looks for Ctrl-C.

use crate::error::Problem;
use pcmvs_core::{Error, Executor, Progress, Stage};
use pcmvs_scene::{Failure, Threads, thread_count};
use pyo3::prelude::*;
use std::{
    num::NonZeroUsize,
    panic::resume_unwind,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    },
    thread::{self, Builder},
    time::Duration,
};

/// How often Ctrl-C is looked for.
const TICK: Duration = Duration::from_millis(50);
/// Stack size in bytes, as that of a main thread.
const STACK: usize = 8 << 20;
/// Most reports per stage, because each may have to wait for the interpreter.
const REPORTS: u64 = 100;

/// A stage, and the share of it that is done.
type Report = (Stage, f64);

/// Where the work reports to, from any of its threads. Only the calling thread touches Python, so that callbacks may use
/// what is not safe with threads, and the work never waits for the interpreter's lock.
struct Reporter<'a> {
    /// Fails once the calling thread no longer listens.
    reports: SyncSender<Report>,
    /// Whether anybody wants reports.
    wanted: bool,
    /// The last report: its stage, and how many of [`REPORTS`] parts were done.
    last: Mutex<Option<(Stage, u64)>>,
    cancelled: &'a AtomicBool,
}

impl Reporter<'_> {
    /// Reports a step, unless it says nothing new. Returns whether anybody listens.
    fn report(&self, stage: Stage, done: u32, total: u32) -> bool {
        let part = u64::from(done.min(total)) * REPORTS / u64::from(total.max(1));
        // Locked until the report has been taken, so that reports come in order.
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.is_some_and(|(stage_before, before)| stage_before == stage && before >= part) {
            return true;
        }
        *last = Some((stage, part));
        self.reports.send((stage, part as f64 / REPORTS as f64)).is_ok()
    }
}

impl Progress for Reporter<'_> {
    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        (!self.wanted || self.report(stage, done, total)) && !self.cancelled.load(Ordering::Relaxed)
    }
}

/// Runs `work` without the interpreter's lock. `progress` is called on this thread with the name of a stage and the share of
/// it that is done. If it returns False, the work is cancelled. If it raises an exception, or Ctrl-C does, the work stops and
/// the exception comes out.
pub fn run<T: Send>(
    py: Python,
    threads: Option<NonZeroUsize>,
    progress: Option<&Bound<PyAny>>,
    work: impl FnOnce(&dyn Executor, &dyn Progress) -> Result<T, Problem> + Send,
) -> PyResult<T> {
    let pool = Threads::new(thread_count(threads)).map_err(Problem::from)?;
    let cancelled = AtomicBool::new(false);
    let (reports, mut listener) = sync_channel(0);
    let reporter = Reporter { reports, wanted: progress.is_some(), last: Mutex::default(), cancelled: &cancelled };
    thread::scope(|scope| {
        // The reporter is dropped when the work is done, which ends the listening.
        let started = Builder::new().stack_size(STACK).spawn_scoped(scope, move || work(&pool, &reporter));
        let worker = started.map_err(|e| Failure::Other(format!("a thread cannot be started ({e})")));
        let worker = worker.map_err(Problem::from)?;
        let heard = listen(py, &mut listener, progress);
        cancelled.store(true, Ordering::Relaxed);
        drop(listener);
        let result = py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic));
        heard?;
        Ok(result?)
    })
}

/// Passes reports on until the work is done. Fails if it must stop before.
fn listen(py: Python, reports: &mut Receiver<Report>, progress: Option<&Bound<PyAny>>) -> PyResult<()> {
    loop {
        let listener = &mut *reports;
        match py.detach(move || listener.recv_timeout(TICK)) {
            Ok((stage, share)) => {
                if let Some(progress) = progress
                    && let Ok(false) = progress.call1((stage.name(), share))?.extract()
                {
                    return Err(Problem::from(Error::Cancelled).into());
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        py.check_signals()?;
    }
}
