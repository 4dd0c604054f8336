//! Threads of an instance: workers that share its memory. JavaScript starts the workers (wasm/npm/threads.js), because only
//! it can; the work is distributed here.

use crate::error::Failed;
use pcmvs_scene::{Thread, Threads};
use std::{
    num::NonZeroUsize,
    sync::{Mutex, OnceLock, PoisonError},
};
use wasm_bindgen::prelude::*;

/// All threads, the one that has started them among them.
static THREADS: OnceLock<Threads> = OnceLock::new();
/// What workers have to run that have not called [`run_thread`] yet.
static WAITING: Mutex<Vec<Thread>> = Mutex::new(Vec::new());

/// The threads, once they have been started.
pub fn started() -> Option<&'static Threads> {
    THREADS.get()
}

/// Makes the calling worker the first of `count` threads. Each of `count - 1` other workers must call `runThread` with an
/// instance of the same module and memory. Throws `PcmvsError` if there are threads already.
#[wasm_bindgen(js_name = startThreads)]
pub fn start_threads(count: usize) -> Result<(), Failed> {
    let count = NonZeroUsize::new(count).ok_or_else(|| Failed::input("the number of threads is at least 1"))?;
    let made = Threads::with_caller(count, |thread| waiting().push(thread));
    let made = made.map_err(|failure| Failed::input(&failure.to_string()))?;
    THREADS.set(made).map_err(|_| Failed::input("the threads have been started already"))
}

/// Works for the thread that has called `startThreads`. Does not return: the worker is ended by `terminate`.
#[wasm_bindgen(js_name = runThread)]
pub fn run_thread() -> Result<(), Failed> {
    let thread = waiting().pop().ok_or_else(|| Failed::input("all threads have a worker"))?;
    thread();
    Ok(())
}

/// The number of threads on which this instance reconstructs.
#[wasm_bindgen]
pub fn threads() -> usize {
    started().map_or(1, Threads::count)
}

fn waiting() -> std::sync::MutexGuard<'static, Vec<Thread>> {
    WAITING.lock().unwrap_or_else(PoisonError::into_inner)
}
