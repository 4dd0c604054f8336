//! What every function does at the border to C: it checks handles and pointers, and catches panics.

use crate::{
    failure::{Failure, Result},
    status::pcmvs_status::{self, InvalidHandle, NullPointer},
};
use std::{
    any::Any,
    mem::{offset_of, size_of},
    panic::{AssertUnwindSafe, catch_unwind},
    ptr,
};

/// A handle's memory. The tag is not in the first words, because that is where allocators link free blocks.
#[repr(C)]
struct Tagged<B> {
    spare: [usize; 4],
    tag: u64,
    body: B,
}

const _: () = assert!(offset_of!(Tagged<u64>, tag) >= 2 * size_of::<usize>());

/// The tag of a handle that has been freed.
const FREED: u64 = 0xDEAD;

/// An opaque C type. It has no values: a pointer to it is a pointer to a [`Tagged`] body.
pub(crate) trait Opaque {
    /// What the handle holds.
    type Body: Sync;
    /// Distinguishes the kinds of handles from each other and from other memory.
    const TAG: u64;
}

/// Moves a body to the heap as a handle.
pub(crate) fn into_handle<O: Opaque>(body: O::Body) -> *mut O {
    Box::into_raw(Box::new(Tagged { spare: [0; 4], tag: O::TAG, body })).cast()
}

/// The body of a handle.
///
/// # Safety
/// The pointer is NULL or points to readable memory, and no other thread frees the handle meanwhile.
pub(crate) unsafe fn body<'a, O: Opaque>(handle: *const O) -> Result<&'a O::Body> {
    let tagged: *const Tagged<O::Body> = handle.cast();
    if tagged.is_null() {
        return Err(Failure::new(NullPointer, "the handle is NULL"));
    }
    // SAFETY: the memory is readable as far as the caller can be trusted; a wrong or freed handle is refused below. The
    // read is volatile because the compiler may assume that freed memory is not read.
    let fits = tagged.is_aligned() && unsafe { ptr::read_volatile(&raw const (*tagged).tag) } == O::TAG;
    if !fits {
        return Err(Failure::new(InvalidHandle, "this is not a handle of this kind, or it has been freed"));
    }
    // SAFETY: the tag shows that `into_handle` made it.
    Ok(unsafe { &(*tagged).body })
}

/// Frees a handle unless `idle` fails. NULL is accepted.
///
/// # Safety
/// As for [`body`]; nothing borrows the body.
pub(crate) unsafe fn free<O: Opaque>(handle: *mut O, idle: impl FnOnce(&O::Body) -> Result<()>) -> pcmvs_status {
    if handle.is_null() {
        return pcmvs_status::Ok;
    }
    // SAFETY: the caller's promise.
    status(unsafe { body(handle) }.and_then(idle).and_then(|()| {
        catch(|| {
            let tagged: *mut Tagged<O::Body> = handle.cast();
            // SAFETY: `body` found the tag.
            unsafe {
                ptr::write_volatile(&raw mut (*tagged).tag, FREED);
                drop(Box::from_raw(tagged));
            }
            Ok(())
        })
    }))
}

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

    struct Opaque7;

    impl Opaque for Opaque7 {
        type Body = LastFailure;
        const TAG: u64 = 7;
    }

    #[test]
    fn a_panic_is_a_failure_that_stays() {
        let handle = into_handle::<Opaque7>(LastFailure::default());
        // SAFETY: the handle lives.
        let failure = unsafe { body(handle.cast_const()) }.unwrap();
        let result = catch(|| std::panic::resume_unwind(Box::new("broken")));
        assert_eq!(failure.keep(result, None), pcmvs_status::Panic);
        assert_eq!(failure.keep(Err(Failure::new(NullPointer, "later")), None), NullPointer);
        assert_eq!(failure.check().map_err(|f| f.status), Err(pcmvs_status::Panic));
        assert_eq!(pcmvs_error::from(failure).status, pcmvs_status::Panic as u32);
        // SAFETY: nothing borrows it any more.
        assert_eq!(unsafe { free(handle, |_| Ok(())) }, pcmvs_status::Ok);
    }
}
