//! The host's progress callback as a progress sink of the core.

#[cfg(feature = "allocator")]
use crate::allocator::failures;
use crate::{
    clock::Clock,
    failure::Failure,
    status::pcmvs_status::{Cancelled, OutOfMemory},
};
use pcmvs_core::{
    Progress, Stage,
    frame::{ORDER, position},
};
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

/// Receives progress: `done` of `total` steps of `stage`, a `pcmvs_stage`, are complete. Stages come in their order and
/// `done` never decreases within a stage. Return 0 to continue. Any other value cancels: the call then returns
/// `PCMVS_STATUS_CANCELLED` as soon as it can and does not call back again.
///
/// Called only on the thread that made the call. It must not throw. Of the functions that take the frame or calibration, it
/// may call `pcmvs_frame_error` and `pcmvs_calibration_error`; others fail with `PCMVS_STATUS_BUSY` if the running call
/// excludes them.
pub type pcmvs_progress_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, stage: u32, done: u32, total: u32) -> c_int>;

/// Every stage is reported in thousandths, whatever its own steps are.
const TOTAL: u32 = 1000;

/// Identifies the current thread among those that are running, by the address of a thread-local byte.
/// `std::thread::current` would allocate memory on every thread of the host, which stays until that thread ends.
fn this_thread() -> usize {
    thread_local!(static MARK: Cell<u8> = const { Cell::new(0) });
    MARK.with(|mark| ptr::from_ref(mark).addr())
}

/// Without an allocator of its own, the crate learns of no failure.
#[cfg(not(feature = "allocator"))]
const fn failures() -> u64 {
    0
}

/// Reports to the host on one thread, never backwards, and times the stages.
pub(crate) struct HostProgress<'a> {
    clock: &'a Clock,
    /// The stage that started last, and when.
    started: Mutex<Option<(Stage, Instant)>>,
    callback: pcmvs_progress_fn,
    user: *mut c_void,
    /// The thread that made the call, if its work may run on others too.
    caller: Option<usize>,
    cancelled: AtomicBool,
    /// How many allocations had failed when the call began. If there are more, the call ends.
    failures: u64,
    /// Stage and thousandths reported last.
    last: Mutex<(Stage, u32)>,
}

// SAFETY: `callback` and `user` are used only on the thread that made the call.
unsafe impl Sync for HostProgress<'_> {}

impl<'a> HostProgress<'a> {
    /// For one call on the current thread.
    pub fn new(clock: &'a Clock, callback: pcmvs_progress_fn, user: *mut c_void, has_threads: bool) -> Self {
        Self {
            clock,
            started: Mutex::new(None),
            callback,
            user,
            caller: has_threads.then(this_thread),
            cancelled: AtomicBool::new(false),
            failures: failures(),
            last: Mutex::new((ORDER[0], 0)),
        }
    }

    fn out_of_memory(&self) -> bool {
        failures() != self.failures
    }

    /// Why the call really failed: the core knows only that it was told to stop.
    pub fn explain(&self, failure: Failure) -> Failure {
        if failure.status != Cancelled || self.cancelled.load(Ordering::Relaxed) || !self.out_of_memory() {
            return failure;
        }
        let message =
            "the allocator returned NULL: provide more memory, or set max_memory to refuse large frames early";
        Failure { status: OutOfMemory, message: message.into(), ..failure }
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
        if self.cancelled.load(Ordering::Relaxed) || self.out_of_memory() {
            return false;
        }
        let Some(callback) = self.callback.filter(|_| self.on_callers_thread()) else { return true };
        let done = (u64::from(done) * u64::from(TOTAL) / u64::from(total.max(1))).min(u64::from(TOTAL)) as u32;
        let now = {
            let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
            *last = [*last, (stage, done)]
                .into_iter()
                .max_by_key(|&(stage, done)| (position(stage), done))
                .unwrap_or(*last);
            *last
        };
        // SAFETY: the host keeps callback and user alive for the call.
        let go_on = unsafe { callback(self.user, now.0.id(), now.1, TOTAL) } == 0;
        self.cancelled.fetch_or(!go_on, Ordering::Relaxed);
        go_on
    }
}
