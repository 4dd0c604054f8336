//! The batches of jobs that the host's threads may run now. A host's thread that comes late finds its batch closed, and a batch
//! is not closed while a thread runs one of its jobs.

use std::{
    collections::BTreeMap,
    ffi::c_void,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

/// Runs one job of the batch at an address.
type RunOne = unsafe fn(batch: usize, index: usize);

/// A batch that is open.
struct Entry {
    batch: usize,
    run_one: RunOne,
    /// Number of threads that run one of its jobs.
    running: usize,
}

struct Batches {
    given: usize,
    open: BTreeMap<usize, Entry>,
}

static BATCHES: Mutex<Batches> = Mutex::new(Batches { given: 0, open: BTreeMap::new() });
/// A thread has ended its job.
static ENDED: Condvar = Condvar::new();

fn batches() -> MutexGuard<'static, Batches> {
    BATCHES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps a batch open while it lives. When it is dropped, it waits for the jobs that run.
pub(crate) struct Open {
    /// What the host passes back with each job.
    pub number: usize,
}

impl Open {
    /// Opens the batch at an address, which stays valid for as long as the value lives.
    pub fn new(batch: usize, run_one: RunOne) -> Self {
        let mut batches = batches();
        batches.given = batches.given.wrapping_add(1).max(1);
        let number = batches.given;
        batches.open.insert(number, Entry { batch, run_one, running: 0 });
        Self { number }
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        let mut batches = batches();
        while batches.open.get(&self.number).is_some_and(|entry| entry.running > 0) {
            batches = ENDED.wait(batches).unwrap_or_else(PoisonError::into_inner);
        }
        batches.open.remove(&self.number);
        if batches.open.is_empty() {
            // An empty map may keep memory.
            batches.open = BTreeMap::new();
        }
    }
}

/// Runs one job of a batch, or nothing if the batch is closed. The host's threads call it.
///
/// # Safety
/// None: `job` is only compared.
pub(crate) unsafe extern "C" fn run_job(job: *mut c_void, index: u32) {
    let number = job.addr();
    let (batch, run_one) = {
        let mut batches = batches();
        let Some(entry) = batches.open.get_mut(&number) else { return };
        entry.running += 1;
        (entry.batch, entry.run_one)
    };
    // SAFETY: a batch with a running job stays open, and therefore valid. A job catches its own panics.
    unsafe { run_one(batch, index as usize) };
    if let Some(entry) = batches().open.get_mut(&number) {
        entry.running -= 1;
    }
    ENDED.notify_all();
}
