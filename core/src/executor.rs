//! Where independent pieces of work run.

use alloc::vec::Vec;
use spin::Mutex;

/// Runs independent pieces of work, in any order and on any thread. The results come back in order.
pub trait Executor: Sync {
    /// `(0..count).map(|i| job(scratch, i))`. While a piece runs it has a scratch for itself: one of `spare`, or a new one
    /// if they are all in use. All end up in `spare`. The content of a scratch does not change a result.
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

/// Buffers that no piece of work is using. The lock is held only to take one out or to put one back.
#[derive(Debug, Default)]
pub struct Pool<S>(Mutex<Vec<S>>);

impl<S> From<Vec<S>> for Pool<S> {
    fn from(spare: Vec<S>) -> Self {
        Self(Mutex::new(spare))
    }
}

impl<S: Default> Pool<S> {
    /// One of the buffers, or a new one.
    pub fn take(&self) -> S {
        let spare = self.0.lock().pop();
        spare.unwrap_or_default()
    }

    /// Runs some work with a buffer for itself.
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
