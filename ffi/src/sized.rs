//! Structs that grow: later versions add members at the end, and the size says which version the caller knows.

use crate::{
    boundary::{out, status},
    failure::{Failure, Result},
    status::pcmvs_status::{self, InvalidStruct, NullPointer},
};
use std::{
    mem::{MaybeUninit, size_of},
    ptr,
};

/// No version of any struct is larger, in bytes.
const MAX_SIZE: usize = 4096;

/// A struct that grows only at its end.
pub(crate) trait Growing: Copy {
    /// Size in the first version of this ABI that had the struct, in bytes. It stays when the struct grows.
    const FIRST_SIZE: usize;
}

/// A struct that callers hand in. It begins with its size.
///
/// # Safety
/// Any bytes are a valid value (numbers, raw pointers, nullable function pointers), the first member is
/// `struct_size: u32`, and there is no padding.
pub(crate) unsafe trait Versioned: Growing {
    /// The values of members that an older caller does not know.
    fn defaults() -> Self;

    /// Whether the members that later versions may use are zero.
    fn reserved_is_zero(&self) -> bool {
        true
    }
}

/// Why a struct cannot be read.
pub(crate) enum Unreadable {
    Null,
    /// No version has this size.
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
            // A struct that was never initialised usually has an absurd size.
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
    if !(T::FIRST_SIZE..=MAX_SIZE).contains(&size) {
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
    if value.reserved_is_zero() { Ok(value) } else { Err(Unreadable::Unknown) }
}

/// [`take`] whose failure names the argument.
///
/// # Safety
/// As for [`take`].
pub(crate) unsafe fn read<T: Versioned>(source: *const T, name: &str) -> Result<T> {
    // SAFETY: the caller's promise.
    unsafe { take(source) }.map_err(|problem| problem.failure(name))
}

/// Reads an array. The distance of its elements is the `struct_size` of the first one.
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
                let problem = format!("`{name}[{i}]`: its struct_size differs from that of the first element");
                return Err(Failure::new(InvalidStruct, problem));
            }
            read(element, &format!("{name}[{i}]"))
        };
        (0..count).map(element).collect()
    }
}

/// Writes a struct for a caller that has `size` bytes for it. Members that only the caller knows become zero.
///
/// # Safety
/// `target` is NULL or has `size` writable bytes.
pub(crate) unsafe fn write<T: Growing>(target: *mut T, size: usize, value: &T, name: &str) -> Result<()> {
    const { assert!(T::FIRST_SIZE <= size_of::<T>()) };
    let target: *mut u8 = out(target, name)?.cast();
    if !(T::FIRST_SIZE..=MAX_SIZE).contains(&size) {
        return Err(Failure::new(
            InvalidStruct,
            format!("`{name}`: {size} bytes are not the size of any version of it"),
        ));
    }
    let known = size.min(size_of::<T>());
    // SAFETY: the caller's promise.
    unsafe {
        ptr::copy_nonoverlapping(ptr::from_ref(value).cast::<MaybeUninit<u8>>(), target.cast(), known);
        target.add(known).write_bytes(0, size - known);
    }
    Ok(())
}

/// Writes a struct with its size, so that the caller can hand it in. The caller has `size` bytes for it.
///
/// # Safety
/// As for [`write`].
pub(crate) unsafe fn write_versioned<T: Versioned>(target: *mut T, size: usize, value: &T, name: &str) -> Result<()> {
    // SAFETY: the caller's promise; the struct begins with its size.
    unsafe { write(target, size, value, name).map(|()| target.cast::<u32>().write_unaligned(size as u32)) }
}

/// Writes a struct's defaults for a caller that has `size` bytes for it.
///
/// # Safety
/// As for [`write`].
pub(crate) unsafe fn init<T: Versioned>(target: *mut T, size: usize, name: &str) -> pcmvs_status {
    // SAFETY: the caller's promise.
    status(unsafe { write_versioned(target, size, &T::defaults(), name) })
}

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
}
