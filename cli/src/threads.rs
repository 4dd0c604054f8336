//! The core's independent pieces of work on the host's threads.

use pcmvs_core::Executor;
use std::{
    num::NonZeroUsize,
    panic::resume_unwind,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

/// Runs work on at most a fixed number of threads, counting the caller's. Calls may nest (views within frames): an inner
/// call takes the threads that outer ones leave idle.
#[derive(Debug)]
pub struct Threads {
    idle: AtomicUsize,
}

/// A thread taken from the idle ones until dropped.
struct Taken<'a>(&'a AtomicUsize);

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

impl Threads {
    pub fn new(count: NonZeroUsize) -> Self {
        Self { idle: AtomicUsize::new(count.get() - 1) }
    }

    fn take(&self) -> Option<Taken<'_>> {
        let less = |idle: usize| idle.checked_sub(1);
        self.idle.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less).ok().map(|_| Taken(&self.idle))
    }

    /// [`Executor::map`] with at most `most` pieces at a time.
    pub fn map_at_most<T: Send>(&self, most: usize, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
        self.map_at_most_with(most, &mut Vec::<()>::new(), count, |(), i| job(i))
    }

    /// [`Executor::map_with`] with at most `most` pieces at a time.
    fn map_at_most_with<S: Default + Send, T: Send>(
        &self,
        most: usize,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        let next = AtomicUsize::new(0);
        let spare = Mutex::new(spare);
        let spare = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        let work = || {
            let mut scratch = spare().pop().unwrap_or_default();
            let mut done = Vec::new();
            loop {
                let i = next.fetch_add(1, Ordering::Relaxed);
                if i >= count {
                    spare().push(scratch);
                    return done;
                }
                done.push((i, job(&mut scratch, i)));
            }
        };
        let helpers: Vec<_> = (1..count.min(most)).map_while(|_| self.take()).collect();
        let mut results = thread::scope(|scope| {
            let run = |taken| {
                scope.spawn(|| {
                    let _taken: Taken = taken;
                    work()
                })
            };
            let handles: Vec<_> = helpers.into_iter().map(run).collect();
            let mut results = work();
            for handle in handles {
                results.extend(handle.join().unwrap_or_else(|panic| resume_unwind(panic)));
            }
            results
        });
        results.sort_unstable_by_key(|&(i, _)| i);
        results.into_iter().map(|(_, result)| result).collect()
    }
}

impl Executor for Threads {
    fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        self.map_at_most_with(usize::MAX, spare, count, job)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_and_no_more_threads_run_than_given() {
        for count in 1..5 {
            let threads = Threads::new(NonZeroUsize::new(count).unwrap());
            let (running, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let result = threads.map(6, |i| {
                threads.map(7, |j| {
                    most.fetch_max(running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                    thread::sleep(std::time::Duration::from_millis(1));
                    running.fetch_sub(1, Ordering::SeqCst);
                    10 * i + j
                })
            });
            let expected: Vec<Vec<_>> = (0..6).map(|i| (0..7).map(|j| 10 * i + j).collect()).collect();
            assert_eq!(result, expected);
            assert!(most.into_inner() <= count);
            assert_eq!(threads.idle.into_inner(), count - 1);
        }
    }
}
