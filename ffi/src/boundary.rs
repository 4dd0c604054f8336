//! What every function does at the border to C.

use crate::{
    error::Failure,
    status::pcmvs_status::{self, InvalidHandle, InvalidStruct, NullPointer},
};
use std::{
    any::Any,
    mem::{MaybeUninit, offset_of, size_of},
    panic::{AssertUnwindSafe, catch_unwind},
    ptr,
};

pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// A handle's memory. Allocators keep lists of free blocks in the blocks' first words, so the tag does not lie there.
#[repr(C)]
struct Tagged<B> {
    spare: [usize; 4],
    tag: u64,
    body: B,
}

/// What a handle that has been freed holds as its tag.
const FREED: u64 = 0xDEAD;

/// An opaque C type. Values of it are never made: pointers to it point to its tagged body.
pub(crate) trait Opaque {
    /// What the handle holds.
    type Body: Sync;
    /// Tells the kinds of handles from each other and from other memory.
    const TAG: u64;
}

/// Moves a body to the heap as a handle.
pub(crate) fn into_handle<O: Opaque>(body: O::Body) -> *mut O {
    Box::into_raw(Box::new(Tagged { spare: [0; 4], tag: O::TAG, body })).cast()
}

/// The body of a handle.
///
/// # Safety
/// The pointer is NULL or to at least readable memory, and no other thread frees the handle meanwhile.
pub(crate) unsafe fn body<'a, O: Opaque>(handle: *const O) -> Result<&'a O::Body> {
    let tagged: *const Tagged<O::Body> = handle.cast();
    if tagged.is_null() {
        return Err(Failure::new(NullPointer, "the handle is NULL"));
    }
    // SAFETY: readable as far as the caller can be trusted; a wrong or freed handle ends here. Volatile, as nothing
    // else tells the compiler that freed memory may be looked at.
    let fits = tagged.is_aligned() && unsafe { ptr::read_volatile(&raw const (*tagged).tag) } == O::TAG;
    if !fits {
        return Err(Failure::new(InvalidHandle, "this is no handle of this kind, or it has been freed"));
    }
    // SAFETY: the tag says that `into_handle` made it.
    Ok(unsafe { &(*tagged).body })
}

/// Frees a handle. NULL is fine.
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

/// Runs something; a panic becomes a failure.
pub(crate) fn catch<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    // What a panic leaves half-done is behind a handle that is not used any more.
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(Failure::panic(text_of(&*panic))))
}

fn text_of(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("a panic without a message")
}

/// The number of a result, for functions that keep no detail.
pub(crate) fn status(result: Result<()>) -> pcmvs_status {
    result.map_or_else(|failure| failure.status, |()| pcmvs_status::Ok)
}

/// Checks a pointer that a result goes to.
pub(crate) fn out<T>(pointer: *mut T, name: &str) -> Result<*mut T> {
    if pointer.is_null() {
        return Err(Failure::new(NullPointer, format!("`{name}` is NULL")));
    }
    Ok(pointer)
}

/// A struct that grows at its end only.
pub(crate) trait Growing: Copy {
    /// Size in the first version that had the struct. It stays when the struct grows.
    const FIRST_SIZE: usize;
}

/// A struct that callers hand in: begins with its size.
///
/// # Safety
/// Any bytes are a valid value (numbers, raw pointers, nullable function pointers), the first member is
/// `struct_size: u32`, and there is no padding.
pub(crate) unsafe trait Versioned: Growing {
    /// What members hold that an older caller does not know.
    fn defaults() -> Self;
}

/// Why a struct cannot be read.
pub(crate) enum Unreadable {
    Null,
    /// Its size is no version's.
    Size(usize),
    /// It sets members of a later version.
    Unknown,
}

impl Unreadable {
    /// What a call returns for it.
    pub fn status(&self) -> pcmvs_status {
        match self {
            Self::Null => NullPointer,
            Self::Size(_) | Self::Unknown => InvalidStruct,
        }
    }

    fn failure(&self, name: &str) -> Failure {
        let message = match self {
            Self::Null => format!("`{name}` is NULL"),
            // A struct that was never initialised mostly claims an absurd size.
            Self::Size(size) => format!("`{name}`: struct_size is {size}: call its init function first"),
            Self::Unknown => format!("`{name}` sets members that this version of the library does not know"),
        };
        Failure::new(self.status(), message)
    }
}

/// Reads a struct of any version; allocates nothing.
///
/// # Safety
/// `source` is NULL or points to as many bytes as its `struct_size` says.
pub(crate) unsafe fn take<T: Versioned>(source: *const T) -> std::result::Result<T, Unreadable> {
    if source.is_null() {
        return Err(Unreadable::Null);
    }
    let bytes: *const u8 = source.cast();
    // SAFETY: the caller's promise; every version begins with its size.
    let size = unsafe { bytes.cast::<u32>().read_unaligned() } as usize;
    if !(T::FIRST_SIZE..=MOST_BYTES).contains(&size) {
        return Err(Unreadable::Size(size));
    }
    let known = size.min(size_of::<T>());
    // SAFETY: `size` bytes are readable.
    if (known..size).any(|i| unsafe { *bytes.add(i) } != 0) {
        return Err(Unreadable::Unknown);
    }
    let mut value = T::defaults();
    // SAFETY: both hold `known` bytes, and any bytes are a valid value.
    unsafe { ptr::copy_nonoverlapping(bytes, (&raw mut value).cast(), known) };
    Ok(value)
}

/// [`take`] that says what is wrong with which argument.
///
/// # Safety
/// As for [`take`].
pub(crate) unsafe fn read<T: Versioned>(source: *const T, name: &str) -> Result<T> {
    // SAFETY: the caller's promise.
    unsafe { take(source) }.map_err(|problem| problem.failure(name))
}

/// No version of any struct is larger.
const MOST_BYTES: usize = 4096;

/// Reads an array whose elements lie `struct_size` of the first one apart.
///
/// # Safety
/// `first` is NULL or points to `count` structs of one version.
pub(crate) unsafe fn read_array<T: Versioned>(first: *const T, count: usize, name: &str) -> Result<Vec<T>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    // SAFETY: the caller's promise, also for every further element.
    unsafe {
        read(first, name)?;
        let size = first.cast::<u32>().read_unaligned();
        let element = |i: usize| {
            let element: *const T = first.cast::<u8>().add(i * size as usize).cast();
            if element.cast::<u32>().read_unaligned() != size {
                let problem = format!("`{name}`[{i}]: its struct_size differs from the first one's");
                return Err(Failure::new(InvalidStruct, problem));
            }
            read(element, &format!("{name}[{i}]"))
        };
        (0..count).map(element).collect()
    }
}

/// Writes a struct for a caller that has `size` bytes for it: as many as both know, zeros beyond.
///
/// # Safety
/// `target` is NULL or has `size` writable bytes.
pub(crate) unsafe fn write<T: Growing>(target: *mut T, size: usize, value: &T, name: &str) -> Result<()> {
    const { assert!(T::FIRST_SIZE <= size_of::<T>()) };
    let target: *mut u8 = out(target, name)?.cast();
    if !(T::FIRST_SIZE..=MOST_BYTES).contains(&size) {
        return Err(Failure::new(InvalidStruct, format!("`{name}`: {size} bytes are no version of it")));
    }
    let known = size.min(size_of::<T>());
    // SAFETY: the caller's promise.
    unsafe {
        ptr::copy_nonoverlapping(ptr::from_ref(value).cast::<MaybeUninit<u8>>(), target.cast(), known);
        target.add(known).write_bytes(0, size - known);
    }
    Ok(())
}

/// Writes a struct's defaults for a caller that has `size` bytes for it.
///
/// # Safety
/// As for [`write`].
pub(crate) unsafe fn init<T: Versioned>(target: *mut T, size: usize, name: &str) -> pcmvs_status {
    // SAFETY: the caller's promise; the struct begins with its size.
    status(unsafe { write(target, size, &T::defaults(), name) }.map(|()| unsafe {
        target.cast::<u32>().write_unaligned(size as u32);
    }))
}

const _: () = assert!(offset_of!(Tagged<u64>, tag) >= 2 * size_of::<usize>());

#[cfg(test)]
mod tests {
    use super::*;

    /// A struct as a first version had it, and as a second one has it.
    #[repr(C)]
    #[derive(Clone, Copy)]
    struct First {
        struct_size: u32,
        a: u32,
    }

    #[repr(C)]
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct Second {
        struct_size: u32,
        a: u32,
        b: u32,
    }

    impl Growing for First {
        const FIRST_SIZE: usize = 8;
    }

    // SAFETY: numbers only, the size first, no padding.
    unsafe impl Versioned for First {
        fn defaults() -> Self {
            Self { struct_size: 8, a: 1 }
        }
    }

    impl Growing for Second {
        const FIRST_SIZE: usize = 8;
    }

    // SAFETY: as above.
    unsafe impl Versioned for Second {
        fn defaults() -> Self {
            Self { struct_size: 12, a: 1, b: 2 }
        }
    }

    #[test]
    fn structs_of_older_and_newer_versions_are_read() {
        let old = First { struct_size: 8, a: 7 };
        // SAFETY: the struct holds as many bytes as it says.
        let read_old: Second = unsafe { read((&raw const old).cast(), "old") }.unwrap();
        assert_eq!((read_old.a, read_old.b), (7, 2), "what the caller does not know has its default");

        let mut new = Second { struct_size: 12, a: 7, b: 0 };
        // SAFETY: as above.
        let read_new: First = unsafe { read((&raw const new).cast(), "new") }.unwrap();
        assert_eq!(read_new.a, 7);
        new.b = 1;
        // SAFETY: as above.
        let refused = unsafe { read::<First>((&raw const new).cast(), "new") };
        assert_eq!(refused.err().map(|f| f.status), Some(InvalidStruct), "what the library does not know must be zero");
    }

    #[test]
    fn init_writes_no_more_than_the_caller_has() {
        let mut old = [First { struct_size: 0, a: 0 }, First { struct_size: 9, a: 9 }];
        // SAFETY: eight bytes are there.
        assert_eq!(unsafe { init::<Second>((&raw mut old[0]).cast(), 8, "old") }, pcmvs_status::Ok);
        assert_eq!((old[0].struct_size, old[0].a, old[1].struct_size, old[1].a), (8, 1, 9, 9));

        let mut new = Second { struct_size: 9, a: 9, b: 9 };
        // SAFETY: twelve bytes are there.
        assert_eq!(unsafe { init::<First>((&raw mut new).cast(), 12, "new") }, pcmvs_status::Ok);
        assert_eq!(new, Second { struct_size: 12, a: 1, b: 0 });
    }

    struct Opaque7;

    impl Opaque for Opaque7 {
        type Body = crate::error::LastFailure;
        const TAG: u64 = 7;
    }

    #[test]
    fn a_panic_is_a_failure_that_stays() {
        let handle = into_handle::<Opaque7>(crate::error::LastFailure::default());
        // SAFETY: the handle lives.
        let failure = unsafe { body(handle.cast_const()) }.unwrap();
        let result = catch(|| std::panic::resume_unwind(Box::new("broken")));
        assert_eq!(failure.keep(result, None), pcmvs_status::Panic);
        assert_eq!(failure.keep(Err(Failure::new(NullPointer, "later")), None), NullPointer);
        assert_eq!(failure.check().map_err(|f| f.status), Err(pcmvs_status::Panic));
        assert_eq!(failure.get().status, pcmvs_status::Panic as u32);
        // SAFETY: nothing borrows it any more.
        assert_eq!(unsafe { free(handle, |_| Ok(())) }, pcmvs_status::Ok);
    }
}
