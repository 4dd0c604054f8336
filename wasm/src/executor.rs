//! What runs the independent pieces of a reconstruction.

use pcmvs_core::{Executor, Serial};

/// The instance's threads if they have been started, otherwise the calling thread.
pub fn executor() -> &'static dyn Executor {
    #[cfg(feature = "threads")]
    if let Some(threads) = crate::threads::started() {
        return threads;
    }
    &Serial
}
