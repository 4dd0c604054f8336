//! Executors that run all jobs on one thread and tell them from the rest of the work.

use pcmvs_core::{Executor, Serial};
use std::{
    hint::black_box,
    sync::{Mutex, PoisonError},
    time::Instant,
};

/// Runs the jobs of one call of an executor. callgrind tells what is done in this function from the rest, so it
/// must not be inlined.
#[inline(never)]
pub fn all<T>(run: impl FnOnce() -> T) -> T {
    black_box(run())
}

/// Runs all jobs in [`all`], as [`Serial`] does.
pub struct Marked;

impl Executor for Marked {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        all(|| Serial.run(count, job));
    }
}

/// Measures the seconds of each job.
#[derive(Default)]
pub struct Timed(Mutex<Vec<Vec<f64>>>);

impl Executor for Timed {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        let timed = |i| {
            let start = Instant::now();
            job(i);
            start.elapsed().as_secs_f64()
        };
        let seconds = (0..count).map(timed).collect();
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(seconds);
    }
}

impl Timed {
    /// The seconds of work that took `whole` seconds on one thread. Each of the threads takes the next job when it is free,
    /// and all wait for the last job of a call.
    pub fn seconds(&self, whole: f64, threads: usize) -> f64 {
        let calls = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let shared: f64 = calls.iter().flatten().sum();
        let length = |jobs: &Vec<f64>| {
            let mut busy = vec![0.0; threads];
            for job in jobs {
                let next = busy.iter_mut().min_by(|a: &&mut f64, b| a.total_cmp(b)).expect("there is a thread");
                *next += job;
            }
            busy.into_iter().fold(0.0, f64::max)
        };
        whole - shared + calls.iter().map(length).sum::<f64>()
    }
}
