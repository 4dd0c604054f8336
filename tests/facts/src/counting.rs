//! An allocator that counts, for tests of memory. A test binary makes it its own by
//! `#[global_allocator] static ALLOCATOR: Counting = Counting;`.
#![allow(unsafe_code)]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    cell::Cell,
};

/// The system's allocator. It counts the bytes that each thread has allocated, and their peak, so that tests may run side by
/// side. What is measured must run on one thread.
#[derive(Debug)]
pub struct Counting;

thread_local! {
    // Negative on a thread that frees what others have allocated.
    static TAKEN: Cell<isize> = const { Cell::new(0) };
    static PEAK: Cell<isize> = const { Cell::new(0) };
}

// SAFETY: all calls are forwarded to the system allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        TAKEN.set(TAKEN.get() + layout.size().cast_signed());
        PEAK.set(PEAK.get().max(TAKEN.get()));
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        TAKEN.set(TAKEN.get() - layout.size().cast_signed());
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// Runs some work on this thread. Returns its result, and the peak of the bytes that it allocated.
pub fn peak_of<T>(work: impl FnOnce() -> T) -> (T, u64) {
    let before = TAKEN.get();
    PEAK.set(before);
    let result = work();
    (result, (PEAK.get() - before).cast_unsigned() as u64)
}
