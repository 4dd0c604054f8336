//! What the calls on one handle share: a lock that never waits, and the last failure.

use crate::{
    boundary::catch,
    failure::{Failure, LastFailure, Result},
    status::pcmvs_status::{self, Busy},
};
use std::sync::{RwLock, TryLockError};

/// What a handle holds. Calls that only read it may run at the same time; any other call needs it for itself.
pub(crate) struct Locked<T> {
    content: RwLock<T>,
    /// What the handle is called in messages, with its article.
    name: &'static str,
    failure: LastFailure,
}

impl<T> Locked<T> {
    pub fn new(name: &'static str, content: T) -> Self {
        Self { content: RwLock::new(content), name, failure: LastFailure::default() }
    }

    /// Does work during which other such work may run.
    pub fn shared(&self, work: impl FnOnce(&T) -> Result<()>) -> Result<()> {
        self.failure.check()?;
        let guard = self.content.try_read().map_err(|_| self.busy())?;
        catch(|| work(&guard))
    }

    /// Does work during which no other may run.
    pub fn exclusive(&self, work: impl FnOnce(&mut T) -> Result<()>) -> Result<()> {
        self.failure.check()?;
        let mut guard = self.content.try_write().map_err(|_| self.busy())?;
        catch(|| work(&mut guard))
    }

    /// Fails while a call is running. A panic does not matter here, so that the handle can be freed after it.
    pub fn idle(&self) -> Result<()> {
        match self.content.try_write() {
            Err(TryLockError::WouldBlock) => Err(self.busy()),
            _ => Ok(()),
        }
    }

    /// Keeps the failure of a result and returns its status. `frame` is the number of the frame that it belongs to.
    pub fn keep(&self, result: Result<()>, frame: Option<u32>) -> pcmvs_status {
        self.failure.keep(result, frame)
    }

    /// The last failure.
    pub fn failure(&self) -> &LastFailure {
        &self.failure
    }

    fn busy(&self) -> Failure {
        Failure::new(Busy, format!("{} is in use by another call: wait until that call has returned", self.name))
    }
}
