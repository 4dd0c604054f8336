//! The caller's allocator: the one setting of the whole process.
//!
//! Containers of stable Rust take the program's allocator, of which there is one. So this is it: it hands on to what
//! `pcmvs_set_allocator` was given, or to the system.

use crate::{
    boundary::{Growing, Versioned, init, take},
    status::pcmvs_status::{self, InvalidArgument, WrongOrder},
};
use std::{
    alloc::{GlobalAlloc, Layout, System},
    ffi::c_void,
    mem::size_of,
    ptr::null_mut,
    sync::OnceLock,
};

/// Gives `size` bytes, never 0, at an address that is a multiple of `alignment`, a power of two; or NULL if there are none:
/// the process is then aborted.
pub type pcmvs_allocate_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, size: usize, alignment: usize) -> *mut c_void>;

/// Gives `size` bytes in place of the `old_size` at `memory`, with what these held as far as it fits, at the same
/// alignment; or NULL, if there are none: `memory` then stays as it is.
pub type pcmvs_reallocate_fn = Option<
    unsafe extern "C" fn(
        user: *mut c_void,
        memory: *mut c_void,
        old_size: usize,
        size: usize,
        alignment: usize,
    ) -> *mut c_void,
>;

/// Takes memory back; size and alignment are those with which it was asked for last.
pub type pcmvs_deallocate_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, memory: *mut c_void, size: usize, alignment: usize)>;

/// Where the library gets its memory. Its functions are called from every thread that calls the library, at the same time
/// too, and must not call the library themselves.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_allocator {
    /// Set by `pcmvs_allocator_init`.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// Handed to the functions.
    pub user: *mut c_void,
    /// Gives memory.
    pub allocate: pcmvs_allocate_fn,
    /// Makes memory larger or smaller, or NULL: then it is allocated anew and copied.
    pub reallocate: pcmvs_reallocate_fn,
    /// Takes memory back.
    pub deallocate: pcmvs_deallocate_fn,
}

impl Growing for pcmvs_allocator {
    const FIRST_SIZE: usize = size_of::<Self>();
}

// SAFETY: numbers, raw pointers and nullable function pointers, the size first, no padding.
unsafe impl Versioned for pcmvs_allocator {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            reserved: 0,
            user: null_mut(),
            allocate: None,
            reallocate: None,
            deallocate: None,
        }
    }
}

/// What a host gave, checked.
struct Host {
    user: *mut c_void,
    allocate: unsafe extern "C" fn(*mut c_void, usize, usize) -> *mut c_void,
    reallocate: pcmvs_reallocate_fn,
    deallocate: unsafe extern "C" fn(*mut c_void, *mut c_void, usize, usize),
}

// SAFETY: `user` is the host's, which lets it be used on every thread.
unsafe impl Send for Host {}
// SAFETY: as above.
unsafe impl Sync for Host {}

/// The program's allocator.
struct Allocator {
    /// Decided by the first allocation or `pcmvs_set_allocator`, whichever comes first: `None` is the system.
    host: OnceLock<Option<Host>>,
}

#[global_allocator]
static ALLOCATOR: Allocator = Allocator { host: OnceLock::new() };

impl Allocator {
    #[inline]
    fn host(&self) -> Option<&Host> {
        self.host.get_or_init(|| None).as_ref()
    }
}

// SAFETY: both the system's allocator and the host's, by its promise, are what the trait asks for.
unsafe impl GlobalAlloc for Allocator {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        match self.host() {
            None => unsafe { System.alloc(layout) },
            Some(host) => unsafe { (host.allocate)(host.user, layout.size(), layout.align()) }.cast(),
        }
    }

    #[inline]
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        match self.host() {
            None => unsafe { System.alloc_zeroed(layout) },
            Some(_) => {
                let memory = unsafe { self.alloc(layout) };
                if !memory.is_null() {
                    unsafe { memory.write_bytes(0, layout.size()) };
                }
                memory
            }
        }
    }

    #[inline]
    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        match self.host() {
            None => unsafe { System.realloc(memory, layout, size) },
            Some(host) => match host.reallocate {
                Some(reallocate) => {
                    unsafe { reallocate(host.user, memory.cast(), layout.size(), size, layout.align()) }.cast()
                }
                None => unsafe {
                    let moved = self.alloc(Layout::from_size_align_unchecked(size, layout.align()));
                    if !moved.is_null() {
                        moved.copy_from_nonoverlapping(memory, size.min(layout.size()));
                        self.dealloc(memory, layout);
                    }
                    moved
                },
            },
        }
    }

    #[inline]
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        match self.host() {
            None => unsafe { System.dealloc(memory, layout) },
            Some(host) => unsafe { (host.deallocate)(host.user, memory.cast(), layout.size(), layout.align()) },
        }
    }
}

/// Sets an allocator to nothing. `size` is `sizeof *allocator`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_allocator_init(allocator: *mut pcmvs_allocator, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(allocator, size, "allocator") }
}

/// Has the library take all its memory from the caller's allocator, in the whole process and for good. Comes before any
/// other function but the inits and names: once the library has allocated (any other call may, and any that fails), or has
/// an allocator, it fails with `PCMVS_STATUS_WRONG_ORDER`. `allocator` is read during the call only; `user` must last as
/// long as the process uses the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_set_allocator(allocator: *const pcmvs_allocator) -> pcmvs_status {
    // Nothing here allocates: a call that fails leaves the decision open.
    // SAFETY: the caller's promise.
    let given = match unsafe { take(allocator) } {
        Ok(given) => given,
        Err(problem) => return problem.status(),
    };
    let (Some(allocate), Some(deallocate)) = (given.allocate, given.deallocate) else { return InvalidArgument };
    let host = Host { user: given.user, allocate, reallocate: given.reallocate, deallocate };
    ALLOCATOR.host.set(Some(host)).map_or(WrongOrder, |()| pcmvs_status::Ok)
}
