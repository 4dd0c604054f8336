//! What every function does at the border to C: it checks pointers and catches panics.

use crate::{
    failure::{Failure, Result},
    status::pcmvs_status::{self, NullPointer},
};
use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
};

/// Does some work; a panic becomes a failure.
pub(crate) fn catch<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    // What a panic leaves half done is behind a handle that is not used any more.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(Failure::panic(text_of(&*panic))))
}

fn text_of(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without a message")
}

/// The status of a result, for functions that keep no details.
pub(crate) fn status(result: Result<()>) -> pcmvs_status {
    result.map_or_else(|failure| failure.status, |()| pcmvs_status::Ok)
}

/// Checks a pointer that a result is written to.
pub(crate) fn out<T>(pointer: *mut T, name: &str) -> Result<*mut T> {
    if pointer.is_null() {
        return Err(Failure::new(NullPointer, format!("`{name}` is NULL")));
    }
    Ok(pointer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{error::pcmvs_error, failure::LastFailure};

    #[test]
    fn a_panic_is_a_failure_that_stays() {
        let failure = LastFailure::default();
        let result = catch(|| std::panic::resume_unwind(Box::new("broken")));
        assert_eq!(failure.keep(result, None), pcmvs_status::Panic);
        assert_eq!(failure.keep(Err(Failure::new(NullPointer, "later")), None), NullPointer);
        assert_eq!(failure.check().map_err(|f| f.status), Err(pcmvs_status::Panic));
        assert_eq!(pcmvs_error::from(&failure).status, pcmvs_status::Panic as u32);
    }
}
