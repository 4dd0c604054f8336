//! Runs the independent pieces of work of the core on a thread pool.

use crate::failure::Failure;
use pcmvs_core::Executor;
use rayon::{Scope, ThreadPool, ThreadPoolBuilder, prelude::*};
use std::{
    num::NonZeroUsize,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

/// Stack size in bytes. A thread that waits for the last views of a frame may start another frame on top of its stack.
const STACK: usize = 8 << 20;

/// The number of threads that was asked for, or that of the machine's cores.
pub fn thread_count(asked: Option<NonZeroUsize>) -> NonZeroUsize {
    asked.unwrap_or_else(|| thread::available_parallelism().unwrap_or(NonZeroUsize::MIN))
}

/// A fixed number of threads. Calls may nest (views within frames).
#[derive(Debug)]
pub struct Threads {
    pool: ThreadPool,
}

/// What a thread runs until the pool ends.
pub type Thread = Box<dyn FnOnce() + Send>;

/// Shared by the tasks of [`Threads::map_at_most`].
struct Queue<J, T> {
    job: J,
    count: usize,
    next: AtomicUsize,
    done: Mutex<Vec<(usize, T)>>,
}

impl Threads {
    /// Starts the threads.
    pub fn new(count: NonZeroUsize) -> Result<Self, Failure> {
        let pool = ThreadPoolBuilder::new().num_threads(count.get()).stack_size(STACK).build();
        let pool = pool.map_err(|e| Failure::Other(format!("{count} threads cannot be started ({e}): try fewer")))?;
        Ok(Self { pool })
    }

    /// For hosts that start threads themselves, such as a page its workers. The calling thread becomes the first of `count`
    /// threads, and remains it after this value is dropped. `start` is called once for each of the others with what that
    /// thread has to run.
    pub fn with_caller(count: NonZeroUsize, mut start: impl FnMut(Thread)) -> Result<Self, Failure> {
        let pool = ThreadPoolBuilder::new().num_threads(count.get()).use_current_thread().spawn_handler(|thread| {
            start(Box::new(|| thread.run()));
            Ok(())
        });
        let pool = pool.build().map_err(|e| Failure::Other(format!("{count} threads cannot be started: {e}")))?;
        Ok(Self { pool })
    }

    /// The number of threads.
    pub fn count(&self) -> usize {
        self.pool.current_num_threads()
    }

    /// `(0..count).map(job)` with at most `most` jobs at a time, and no more than there are threads.
    pub fn map_at_most<T: Send>(&self, most: usize, count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
        let queue = Queue { job, count, next: AtomicUsize::new(0), done: Mutex::default() };
        let tasks = count.min(most).min(self.count());
        self.pool.scope(|scope| (0..tasks).for_each(|_| queue.spawn(scope)));
        let mut done = queue.done.into_inner().unwrap_or_else(PoisonError::into_inner);
        done.sort_unstable_by_key(|&(i, _)| i);
        done.into_iter().map(|(_, result)| result).collect()
    }
}

impl<J: Fn(usize) -> T + Sync, T: Send> Queue<J, T> {
    /// Spawns the next job, which spawns its successor when it is done. A loop inside one task would not do: a thread that
    /// waits for the last views of its frame could enter the loop, and its frame would have to wait until the loop ends.
    fn spawn<'scope>(&'scope self, scope: &Scope<'scope>) {
        let i = self.next.fetch_add(1, Ordering::Relaxed);
        if i < self.count {
            scope.spawn(move |scope| {
                let result = (self.job)(i);
                self.done.lock().unwrap_or_else(PoisonError::into_inner).push((i, result));
                self.spawn(scope);
            });
        }
    }
}

impl Executor for Threads {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        self.pool.install(|| (0..count).into_par_iter().with_max_len(1).for_each(job));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mapping methods are those of any executor.
    fn any(threads: &Threads) -> &dyn Executor {
        threads
    }

    #[test]
    fn results_come_in_order_and_no_more_jobs_run_than_allowed() {
        for count in 1..5 {
            let threads = Threads::new(NonZeroUsize::new(count).unwrap()).unwrap();
            let [outer, inner] = [(); 2].map(|()| Peak::default());
            let result = threads.map_at_most(3, 9, |i| {
                outer.during(|| {
                    any(&threads).map(7, |j| {
                        inner.during(|| thread::sleep(std::time::Duration::from_millis(1)));
                        10 * i + j
                    })
                })
            });
            let expected: Vec<Vec<_>> = (0..9).map(|i| (0..7).map(|j| 10 * i + j).collect()).collect();
            assert_eq!(result, expected);
            assert!(outer.most.into_inner() <= count.min(3));
            assert!(inner.most.into_inner() <= count);
        }
    }

    #[test]
    fn the_caller_and_the_threads_of_the_host_share_the_jobs() {
        // The caller remains a thread of the pool, and so it is not the test's own thread.
        let work = || {
            let started = AtomicUsize::new(0);
            let count = NonZeroUsize::new(3).unwrap();
            let threads = Threads::with_caller(count, |work| {
                started.fetch_add(1, Ordering::SeqCst);
                thread::spawn(work);
            });
            let threads = threads.unwrap();
            assert_eq!((threads.count(), started.into_inner()), (3, 2));
            // Each of the first three jobs waits until all three run at the same time.
            let together = std::sync::Barrier::new(3);
            let ran_on = any(&threads).map(3, |_| {
                together.wait();
                thread::current().id()
            });
            assert!(ran_on.contains(&thread::current().id()));
        };
        thread::spawn(work).join().unwrap();
    }

    #[test]
    fn no_more_scratch_is_made_than_jobs_run_at_a_time() {
        let threads = Threads::new(NonZeroUsize::new(2).unwrap()).unwrap();
        let mut spare: Vec<Vec<usize>> = Vec::new();
        for _ in 0..3 {
            any(&threads).map_with(&mut spare, 20, |scratch, i| scratch.push(i));
        }
        assert!(spare.len() <= 2);
        assert_eq!(spare.iter().map(Vec::len).sum::<usize>(), 60);
    }

    /// The largest number of jobs that ran at a time.
    #[derive(Default)]
    struct Peak {
        running: AtomicUsize,
        most: AtomicUsize,
    }

    impl Peak {
        fn during<T>(&self, work: impl FnOnce() -> T) -> T {
            self.most.fetch_max(self.running.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            let result = work();
            self.running.fetch_sub(1, Ordering::SeqCst);
            result
        }
    }
}
