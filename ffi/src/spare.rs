//! Memory that the host's allocator could not provide.
//!
//! Most of Rust's containers abort the process if an allocation fails, and an allocator must not panic. Blocks that the
//! host cannot provide come from the system instead, so that the running call can end with a status.

use std::{
    alloc::{GlobalAlloc, Layout, System},
    ptr::null_mut,
    sync::atomic::{
        AtomicBool, AtomicU64, AtomicUsize,
        Ordering::{Acquire, Relaxed, Release},
    },
};

/// How many blocks there may be at a time. A call ends soon after its first failure, so that few are needed. The list
/// is searched whenever memory is freed while a block is in it.
const MOST: usize = 4096;

/// The blocks from the system, by address. It allocates nothing itself.
pub(crate) struct Spare {
    locked: AtomicBool,
    /// Number of entries of `blocks` that are in use, at its beginning.
    count: AtomicUsize,
    blocks: [AtomicUsize; MOST],
    failures: AtomicU64,
}

impl Spare {
    pub const fn new() -> Self {
        Self {
            locked: AtomicBool::new(false),
            count: AtomicUsize::new(0),
            blocks: [const { AtomicUsize::new(0) }; MOST],
            failures: AtomicU64::new(0),
        }
    }

    /// The number of blocks that were asked for so far.
    pub fn failures(&self) -> u64 {
        self.failures.load(Relaxed)
    }

    /// A block from the system. NULL if the system has none either, or if there are too many.
    pub fn allocate(&self, layout: Layout) -> *mut u8 {
        self.failures.fetch_add(1, Relaxed);
        // SAFETY: the layout comes from Rust, so its size is not zero.
        let memory = unsafe { System.alloc(layout) };
        if memory.is_null() {
            return memory;
        }
        let kept = self.lock(|count| {
            let free = self.blocks.get(count)?;
            free.store(memory.addr(), Relaxed);
            self.count.store(count + 1, Release);
            Some(())
        });
        if kept.is_none() {
            // SAFETY: the block was just allocated with this layout.
            unsafe { System.dealloc(memory, layout) };
            return null_mut();
        }
        memory
    }

    /// Whether a block is from the system.
    pub fn has(&self, memory: *mut u8) -> bool {
        self.any() && self.lock(|count| self.find(count, memory)).is_some()
    }

    /// Whether a block is from the system. If so, it is no longer in the list.
    pub fn take(&self, memory: *mut u8) -> bool {
        self.any()
            && self
                .lock(|count| {
                    let place = self.find(count, memory)?;
                    let last = self.blocks[count - 1].load(Relaxed);
                    self.blocks[place].store(last, Relaxed);
                    self.count.store(count - 1, Release);
                    Some(())
                })
                .is_some()
    }

    /// A thread that frees a block knows of its allocation, and so does not see the list empty.
    fn any(&self) -> bool {
        self.count.load(Acquire) > 0
    }

    fn find(&self, count: usize, memory: *mut u8) -> Option<usize> {
        self.blocks[..count].iter().position(|block| block.load(Relaxed) == memory.addr())
    }

    /// Does work on the list while no other thread does. Nothing in it allocates or panics. A mutex of the standard
    /// library could allocate.
    fn lock<T>(&self, work: impl FnOnce(usize) -> Option<T>) -> Option<T> {
        while self.locked.compare_exchange_weak(false, true, Acquire, Relaxed).is_err() {
            std::hint::spin_loop();
        }
        let result = work(self.count.load(Relaxed));
        self.locked.store(false, Release);
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_known_until_they_are_taken() {
        let spare = Box::new(Spare::new());
        let layout = Layout::new::<[u64; 4]>();
        let blocks = [(); 3].map(|()| spare.allocate(layout));
        assert!(blocks.iter().all(|&block| spare.has(block)) && spare.failures() == 3);
        for block in blocks {
            assert!(spare.take(block) && !spare.has(block) && !spare.take(block));
            // SAFETY: it was allocated with this layout.
            unsafe { System.dealloc(block, layout) };
        }
        assert!(!spare.any());
    }

    #[test]
    #[cfg_attr(miri, ignore = "searches a long list thousands of times")]
    fn there_are_not_more_blocks_than_the_list_holds() {
        let spare = Box::new(Spare::new());
        let layout = Layout::new::<u64>();
        let blocks: Vec<_> = (0..MOST).map(|_| spare.allocate(layout)).collect();
        assert!(blocks.iter().all(|block| !block.is_null()) && spare.allocate(layout).is_null());
        for block in blocks.into_iter().filter(|&block| spare.take(block)) {
            // SAFETY: it was allocated with this layout.
            unsafe { System.dealloc(block, layout) };
        }
        assert!(!spare.any());
    }
}
