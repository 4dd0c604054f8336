//! A host's threads.

use pcmvs_core::Executor;
use std::{
    sync::{
        Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
};

/// Runs jobs on this many threads, each taking the next job that is left.
#[derive(Debug, Clone, Copy)]
pub struct Threads(pub usize);

impl Executor for Threads {
    fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        let spare = Mutex::new(spare);
        let next = AtomicUsize::new(0);
        let done = Mutex::new(Vec::new());
        thread::scope(|scope| {
            for _ in 0..self.0 {
                scope.spawn(|| {
                    let mut scratch = spare.lock().expect("no job panics").pop().unwrap_or_default();
                    loop {
                        let i = next.fetch_add(1, Ordering::Relaxed);
                        if i >= count {
                            spare.lock().expect("no job panics").push(scratch);
                            return;
                        }
                        let result = job(&mut scratch, i);
                        done.lock().expect("no job panics").push((i, result));
                    }
                });
            }
        });
        let mut done = done.into_inner().expect("no job panics");
        done.sort_by_key(|&(i, _)| i);
        done.into_iter().map(|(_, result)| result).collect()
    }
}
