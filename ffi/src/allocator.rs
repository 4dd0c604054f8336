//! The caller's allocator, the only setting of the whole process.
//!
//! Containers of stable Rust use the program's global allocator. This one forwards to the functions given to
//! `pcmvs_set_allocator`, or to the system. A failure must not reach Rust's containers, which abort the process: the
//! block then comes from the [spare](crate::spare) memory, and the call ends at its next step.

use crate::{
    sized::{Growing, Versioned, init, take},
    spare::Spare,
    status::pcmvs_status::{self, InvalidArgument, WrongOrder},
};
use std::{
    alloc::{GlobalAlloc, Layout, System},
    ffi::c_void,
    mem::size_of,
    ptr::null_mut,
    sync::OnceLock,
};

/// Allocates `size` bytes, at least 1, at an address that is a multiple of `alignment`, a power of two. Returns NULL if it
/// cannot. The library then takes this block from the C library, and calls that report progress end with
/// `PCMVS_STATUS_OUT_OF_MEMORY` at their next step.
pub type pcmvs_allocate_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, size: usize, alignment: usize) -> *mut c_void>;

/// Resizes the block at `memory` from `old_size` to `size` bytes, at the same alignment, and returns its new address. The
/// contents are kept up to the smaller of the two sizes. Returns NULL if it cannot; the block then stays as it is.
pub type pcmvs_reallocate_fn = Option<
    unsafe extern "C" fn(
        user: *mut c_void,
        memory: *mut c_void,
        old_size: usize,
        size: usize,
        alignment: usize,
    ) -> *mut c_void,
>;

/// Frees the block at `memory`. `size` and `alignment` are those of its last allocation or reallocation.
pub type pcmvs_deallocate_fn =
    Option<unsafe extern "C" fn(user: *mut c_void, memory: *mut c_void, size: usize, alignment: usize)>;

/// Functions that provide the library's memory. They are called on every thread that calls the library, possibly on several
/// at once. They must not call the library.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_allocator {
    /// Set by `pcmvs_allocator_init`.
    pub struct_size: u32,
    /// Zero.
    pub reserved: u32,
    /// Passed to the functions.
    pub user: *mut c_void,
    /// Allocates memory.
    pub allocate: pcmvs_allocate_fn,
    /// Resizes memory. If it is NULL, the library allocates a new block and copies.
    pub reallocate: pcmvs_reallocate_fn,
    /// Frees memory.
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

    fn reserved_is_zero(&self) -> bool {
        self.reserved == 0
    }
}

/// The functions of a host, checked.
struct Host {
    user: *mut c_void,
    allocate: unsafe extern "C" fn(*mut c_void, usize, usize) -> *mut c_void,
    reallocate: pcmvs_reallocate_fn,
    deallocate: unsafe extern "C" fn(*mut c_void, *mut c_void, usize, usize),
}

// SAFETY: `user` is the host's, which allows its use on every thread.
unsafe impl Send for Host {}
// SAFETY: as above.
unsafe impl Sync for Host {}

/// The program's allocator.
struct Allocator {
    /// Decided by the first allocation or `pcmvs_set_allocator`, whichever comes first: `None` is the system.
    host: OnceLock<Option<Host>>,
    /// What the host could not provide.
    spare: Spare,
}

#[global_allocator]
static ALLOCATOR: Allocator = Allocator { host: OnceLock::new(), spare: Spare::new() };

impl Allocator {
    #[inline]
    fn host(&self) -> Option<&Host> {
        self.host.get_or_init(|| None).as_ref()
    }
}

// SAFETY: the system's allocator keeps the trait's contract, and so does the host's, by its promise.
unsafe impl GlobalAlloc for Allocator {
    #[inline]
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        match self.host() {
            None => unsafe { System.alloc(layout) },
            Some(host) => {
                let memory = unsafe { (host.allocate)(host.user, layout.size(), layout.align()) };
                if memory.is_null() { self.spare.allocate(layout) } else { memory.cast() }
            }
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
            Some(host) => {
                if let Some(reallocate) = host.reallocate.filter(|_| !self.spare.has(memory)) {
                    let resized = unsafe { reallocate(host.user, memory.cast(), layout.size(), size, layout.align()) };
                    if !resized.is_null() {
                        return resized.cast();
                    }
                }
                unsafe {
                    let moved = self.alloc(Layout::from_size_align_unchecked(size, layout.align()));
                    if !moved.is_null() {
                        moved.copy_from_nonoverlapping(memory, size.min(layout.size()));
                        self.dealloc(memory, layout);
                    }
                    moved
                }
            }
        }
    }

    #[inline]
    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        match self.host() {
            None => unsafe { System.dealloc(memory, layout) },
            Some(_) if self.spare.take(memory) => unsafe { System.dealloc(memory, layout) },
            Some(host) => unsafe { (host.deallocate)(host.user, memory.cast(), layout.size(), layout.align()) },
        }
    }
}

/// The number of blocks so far that the host's functions could not provide.
pub(crate) fn failures() -> u64 {
    ALLOCATOR.spare.failures()
}

/// Initialises an allocator without functions. `size` is `sizeof *allocator`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_allocator_init(allocator: *mut pcmvs_allocator, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(allocator, size, "allocator") }
}

/// Makes the library take all of its memory from the caller's functions, in the whole process and until it ends. Call it
/// before every function other than `pcmvs_..._init`, `pcmvs_version...`, `pcmvs_status_name` and `pcmvs_stage_...`: once
/// the library has allocated memory or has an allocator, it fails with `PCMVS_STATUS_WRONG_ORDER`. Any other call, and any
/// call that fails, may allocate. `allocator` is read only during the call; `user` must stay valid while the process uses
/// the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_set_allocator(allocator: *const pcmvs_allocator) -> pcmvs_status {
    // Nothing here allocates, so that another call can follow one that fails.
    // SAFETY: the caller's promise.
    let given = match unsafe { take(allocator) } {
        Ok(given) => given,
        Err(problem) => return problem.status(),
    };
    let (Some(allocate), Some(deallocate)) = (given.allocate, given.deallocate) else { return InvalidArgument };
    let host = Host { user: given.user, allocate, reallocate: given.reallocate, deallocate };
    ALLOCATOR.host.set(Some(host)).map_or(WrongOrder, |()| pcmvs_status::Ok)
}
