//! A host's threads.

use pcmvs_core::{Executor, Pool};
use rayon::{ThreadPoolBuilder, prelude::*};
use std::mem::take;

/// Runs jobs on this many threads.
#[derive(Debug, Clone, Copy)]
pub struct Threads(pub usize);

impl Executor for Threads {
    fn map_with<S: Default + Send, T: Send>(
        &self,
        spare: &mut Vec<S>,
        count: usize,
        job: impl Fn(&mut S, usize) -> T + Sync,
    ) -> Vec<T> {
        let threads = ThreadPoolBuilder::new().num_threads(self.0).build().expect("threads can be started");
        let mut scratches = Pool::from(take(spare));
        let piece = |i| scratches.with(|scratch| job(scratch, i));
        let results = threads.install(|| (0..count).into_par_iter().with_max_len(1).map(piece).collect());
        *spare = take(scratches.spare());
        results
    }
}
