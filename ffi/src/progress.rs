//! The host's progress callback behind the core's trait.

use crate::{clock::Clock, options::pcmvs_options, status::pcmvs_stage};
use pcmvs_core::{Progress, Stage, frame::ORDER, frame::position};
use std::{
    cell::Cell,
    ffi::{c_int, c_void},
    ptr,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

/// Told how far a call is: `done` of `total` in `stage`. Stages come in order and `done` never falls within one.
/// Return 0 to go on, anything else to cancel: the call then ends with `PCMVS_STATUS_CANCELLED` as soon as it can, and
/// the callback is not called again. Called on the thread that made the call, never on another. It must not
/// throw, and calls on the same handle fail with `PCMVS_STATUS_BUSY`.
pub type pcmvs_progress_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, stage: pcmvs_stage, done: u32, total: u32) -> c_int>;

/// Every stage is told in thousandths, whatever its own steps are.
const TOTAL: u32 = 1000;

/// Tells the threads that are running apart, by the address of a byte that each has. `std::thread::current` would leave
/// memory with every thread of the host's that has ever called.
fn this_thread() -> usize {
    thread_local!(static MARK: Cell<u8> = const { Cell::new(0) });
    MARK.with(|mark| ptr::from_ref(mark).addr())
}

/// Calls back on one thread, never backwards, and times the stages.
pub(crate) struct HostProgress<'a> {
    clock: &'a Clock,
    /// The stage that started last, and when.
    started: Mutex<Option<(Stage, Instant)>>,
    callback: pcmvs_progress_fn,
    user: *mut c_void,
    /// The thread that called, if pieces of its work may run on others.
    caller: Option<usize>,
    cancelled: AtomicBool,
    /// Place of the stage and thousandths reported last.
    last: Mutex<(u32, u32)>,
}

// SAFETY: `callback` and `user` are only used on the thread that called.
unsafe impl Sync for HostProgress<'_> {}

impl<'a> HostProgress<'a> {
    /// For one call on the current thread.
    pub fn new(options: &pcmvs_options, clock: &'a Clock) -> Self {
        Self {
            clock,
            started: Mutex::new(None),
            callback: options.progress,
            user: options.progress_user,
            caller: options.parallel.map(|_| this_thread()),
            cancelled: AtomicBool::new(false),
            last: Mutex::new((0, 0)),
        }
    }

    fn on_callers_thread(&self) -> bool {
        self.caller.is_none_or(|caller| caller == this_thread())
    }

    /// The stage that started last.
    pub fn stage(&self) -> Option<Stage> {
        self.started.lock().unwrap_or_else(PoisonError::into_inner).map(|(stage, _)| stage)
    }
}

impl Progress for HostProgress<'_> {
    fn on_stage_start(&self, stage: Stage) {
        *self.started.lock().unwrap_or_else(PoisonError::into_inner) = Some((stage, Instant::now()));
    }

    fn on_stage_end(&self, stage: Stage) {
        let started = *self.started.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, started)) = started.filter(|&(begun, _)| begun == stage) {
            self.clock.add(stage, started.elapsed().as_secs_f64());
        }
    }

    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        if self.cancelled.load(Ordering::Relaxed) {
            return false;
        }
        let Some(callback) = self.callback.filter(|_| self.on_callers_thread()) else { return true };
        let done = (u64::from(done) * u64::from(TOTAL) / u64::from(total.max(1))).min(u64::from(TOTAL)) as u32;
        let now = {
            let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
            *last = (*last).max((position(stage) as u32, done));
            *last
        };
        let stage = ORDER[now.0 as usize];
        // SAFETY: the host keeps callback and user alive for the call.
        let go_on = unsafe { callback(self.user, stage.into(), now.1, TOTAL) } == 0;
        self.cancelled.fetch_or(!go_on, Ordering::Relaxed);
        go_on
    }
}
