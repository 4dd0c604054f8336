//! How independent jobs are run: on the calling thread ([`Serial`]) or on the host's threads ([`Executor`]).

use alloc::vec::Vec;
use core::mem::take;
use spin::Mutex;

/// Runs independent jobs, in any order and on any thread.
///
/// Stages take `&dyn Executor`, so that they are compiled once and not again in every program that has threads of its own.
pub trait Executor: Sync {
    /// Calls `job(i)` once for each `i` from 0 to `count - 1`, and returns when all calls have returned.
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync));
}

/// Results are returned in the order of the jobs.
impl dyn Executor + '_ {
    /// Computes `(0..count).map(job)`.
    pub fn map<T: Send>(&self, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let results = slots(count);
        self.run(count, &|i| *results[i].lock() = Some(job(i)));
        contents(results)
    }

    /// Computes `(0..count).map(|i| job(scratch, i))`.
    ///
    /// Each running job has exclusive use of a scratch buffer. It is taken from `spare`, or created if all of them are
    /// in use. All buffers are in `spare` when the call returns. Their content never affects a result.
    pub fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        let mut scratches = Pool::from(take(spare));
        let results = self.map(count, |i| scratches.with(|scratch| job(scratch, i)));
        *spare = take(scratches.spare());
        results
    }

    /// Computes `job(i, part)` for each of the parts, such as mutable slices of one vector.
    pub fn map_parts<P: Send, T: Send>(
        &self,
        parts: impl IntoIterator<Item = P>,
        job: impl Fn(usize, P) -> T + Sync,
    ) -> Vec<T> {
        let parts: Vec<Mutex<Option<P>>> = parts.into_iter().map(|part| Mutex::new(Some(part))).collect();
        self.map(parts.len(), |i| {
            let part = parts[i].lock().take().expect("each job runs once");
            job(i, part)
        })
    }

    /// `map_parts` with scratch buffers as in `map_with`.
    pub fn map_parts_with<S: Default + Send, P: Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        parts: impl IntoIterator<Item = P>,
        job: impl Fn(&mut S, usize, P) -> T + Sync,
    ) -> Vec<T> {
        let mut scratches = Pool::from(take(spare));
        let results = self.map_parts(parts, |i, part| scratches.with(|scratch| job(scratch, i, part)));
        *spare = take(scratches.spare());
        results
    }
}

/// Places for the results of jobs. This and [`contents`] are apart, so that they are compiled once per type of result and not
/// with every call.
#[inline(never)]
fn slots<T>(count: usize) -> Vec<Mutex<Option<T>>> {
    (0..count).map(|_| Mutex::new(None)).collect()
}

/// The results of all jobs.
#[inline(never)]
fn contents<T>(slots: Vec<Mutex<Option<T>>>) -> Vec<T> {
    let mut results = Vec::with_capacity(slots.len());
    results.extend(slots.into_iter().map(|slot| slot.into_inner().expect("an executor runs all jobs")));
    results
}

/// Runs all jobs on the calling thread.
#[derive(Debug, Clone, Copy, Default)]
pub struct Serial;

impl Executor for Serial {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).for_each(job);
    }
}

/// Buffers that are not in use. The lock is held only while a buffer is taken out or put back.
#[derive(Debug, Default)]
pub struct Pool<S>(Mutex<Vec<S>>);

impl<S> From<Vec<S>> for Pool<S> {
    fn from(spare: Vec<S>) -> Self {
        Self(Mutex::new(spare))
    }
}

impl<S: Default> Pool<S> {
    /// Takes one of the buffers, or creates one.
    pub fn take(&self) -> S {
        let spare = self.0.lock().pop();
        spare.unwrap_or_default()
    }

    /// Runs `work` with exclusive use of a buffer.
    pub fn with<T>(&self, work: impl FnOnce(&mut S) -> T) -> T {
        let mut scratch = self.take();
        let result = work(&mut scratch);
        self.0.lock().push(scratch);
        result
    }

    /// All buffers that are not in use.
    pub fn spare(&mut self) -> &mut Vec<S> {
        self.0.get_mut()
    }
}
