//! The host's threads as an executor of the core.

use crate::batches::{Open, run_job};
use pcmvs_core::{Executor, Serial};
use std::{
    any::Any,
    ffi::c_void,
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    ptr::{with_exposed_provenance, without_provenance_mut},
    sync::{Mutex, PoisonError},
};

/// Runs one of the library's jobs. Call it with `job` and the job's index.
pub type pcmvs_job_fn = Option<unsafe extern "C" fn(job: *mut c_void, index: u32)>;

/// Runs jobs on the caller's threads. It calls `run(job, i)` once for every `i` from 0 to `count - 1`, on any threads and
/// in any order, and returns when all of these calls have returned. The library runs jobs that were left out on the
/// calling thread. If the function returns earlier, the library waits for the jobs that have started; a call of `run` that
/// comes later does nothing. Results do not depend on the threads. It must not throw.
pub type pcmvs_parallel_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, count: u32, run: pcmvs_job_fn, job: *mut c_void)>;

/// A `pcmvs_parallel_fn` that is not NULL.
type Parallel = unsafe extern "C" fn(*mut c_void, u32, pcmvs_job_fn, *mut c_void);

/// Runs the core's jobs on the host's threads, or on the calling thread if the host lends none.
#[derive(Clone, Copy)]
pub(crate) struct HostThreads {
    pub parallel: pcmvs_parallel_fn,
    pub user: *mut c_void,
}

// SAFETY: the core calls `run` only on the thread that called it; `user` is the host's.
unsafe impl Sync for HostThreads {}

/// The jobs of one call, shared with the host's threads.
struct Batch<'a> {
    job: &'a (dyn Fn(usize) + Sync),
    states: Vec<Mutex<State>>,
}

/// State of a job.
enum State {
    Waiting,
    Running,
    Done,
    Panicked(Box<dyn Any + Send>),
}

impl Batch<'_> {
    fn run(&self, index: usize) {
        let Some(state) = self.states.get(index) else { return };
        {
            let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
            if !matches!(*state, State::Waiting) {
                return;
            }
            *state = State::Running;
        }
        let done = catch_unwind(AssertUnwindSafe(|| (self.job)(index)));
        *state.lock().unwrap_or_else(PoisonError::into_inner) = done.map_or_else(State::Panicked, |()| State::Done);
    }

    /// # Safety
    /// `batch` points to a batch that lives through the call.
    unsafe fn run_one(batch: usize, index: usize) {
        // SAFETY: the caller's promise; a batch may be shared between threads.
        unsafe { &*with_exposed_provenance::<Self>(batch) }.run(index);
    }
}

impl Executor for HostThreads {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        let Some(parallel) = self.parallel else { return Serial.run(count, job) };
        let batch = Batch { job, states: (0..count).map(|_| Mutex::new(State::Waiting)).collect() };
        // Afterwards no other thread uses the batch.
        self.hand_out(parallel, &batch);
        (0..count).for_each(|i| batch.run(i));
        for state in batch.states {
            match state.into_inner().unwrap_or_else(PoisonError::into_inner) {
                State::Done => {}
                State::Panicked(panic) => resume_unwind(panic),
                State::Waiting | State::Running => {
                    unreachable!("all jobs have been run, and those that run are waited for")
                }
            }
        }
    }
}

impl HostThreads {
    fn hand_out(&self, parallel: Parallel, batch: &Batch) {
        let open = Open::new((&raw const *batch).expose_provenance(), Batch::run_one);
        // SAFETY: the host keeps function and user alive for the call. `job` is a number, which may come late.
        unsafe { parallel(self.user, batch.states.len() as u32, Some(run_job), without_provenance_mut(open.number)) };
    }
}
