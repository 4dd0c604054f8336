//! Shared code of the tests that check the whole method on solids with known ground truth.

pub mod counting;
pub mod errors;
pub mod outline;
pub mod shot;
pub mod steadiness;

pub use errors::Errors;
pub use shot::Shot;
pub use studio::topology;

use pcmvs_scene::Threads;
use std::num::NonZeroUsize;

/// This many threads, as the command line runs the method on them.
pub fn threads(count: usize) -> Threads {
    let count = NonZeroUsize::new(count).expect("there is a thread");
    Threads::new(count).expect("threads can be started")
}
