//! How independent jobs are run: on the calling thread ([`Serial`]) or on the host's threads ([`Executor`]).

use alloc::vec::Vec;
use spin::Mutex;

/// Runs independent jobs, in any order and on any thread. The results are returned in the order of the jobs.
pub trait Executor: Sync {
    /// Computes `(0..count).map(|i| job(scratch, i))`.
    ///
    /// Each running job has exclusive use of a scratch buffer. It is taken from `spare`, or created if all of them are
    /// in use. All buffers are in `spare` when the call returns. Their content never affects a result.
    fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T>;

    /// Computes `(0..count).map(job)`.
    fn map<T: Send>(&self, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
        self.map_with(&mut Vec::<()>::new(), count, |(), i| job(i))
    }

    /// Computes `job(i, part)` for each of the parts, such as mutable slices of one vector.
    fn map_parts<P: Send, T: Send>(
        &self,
        parts: impl IntoIterator<Item = P>,
        job: impl Fn(usize, P) -> T + Sync,
    ) -> Vec<T> {
        self.map_parts_with(&mut Vec::<()>::new(), parts, |(), i, part| job(i, part))
    }

    /// [`Self::map_parts`] with scratch buffers as in [`Self::map_with`].
    fn map_parts_with<S: Default + Send, P: Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        parts: impl IntoIterator<Item = P>,
        job: impl Fn(&mut S, usize, P) -> T + Sync,
    ) -> Vec<T> {
        let parts: Vec<Mutex<Option<P>>> = parts.into_iter().map(|part| Mutex::new(Some(part))).collect();
        self.map_with(spare, parts.len(), |scratch, i| {
            let part = parts[i].lock().take().expect("each job runs once");
            job(scratch, i, part)
        })
    }
}

/// Runs all jobs on the calling thread.
#[derive(Debug, Clone, Copy, Default)]
pub struct Serial;

impl Executor for Serial {
    fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        self.map_parts_with(spare, 0..count, |scratch, _, i| job(scratch, i))
    }

    /// Without the locks that threads need.
    fn map_parts_with<S: Default + Send, P: Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        parts: impl IntoIterator<Item = P>,
        job: impl Fn(&mut S, usize, P) -> T + Sync,
    ) -> Vec<T> {
        let mut scratch = spare.pop().unwrap_or_default();
        let results = parts.into_iter().enumerate().map(|(i, part)| job(&mut scratch, i, part)).collect();
        spare.push(scratch);
        results
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
