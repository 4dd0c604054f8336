//! Arrays in the caller's memory.

use crate::{
    boundary::out,
    failure::{Failure, Result},
    status::pcmvs_status::{BufferTooSmall, InvalidArgument},
};
use std::{mem::size_of, ptr::copy_nonoverlapping};

/// The caller's buffer for elements.
pub(crate) struct Target {
    pub buffer: *mut u8,
    pub capacity: usize,
    pub stride: usize,
    pub count: *mut usize,
}

impl Target {
    /// Writes the elements and their number. On failure nothing is written.
    ///
    /// # Safety
    /// The buffer has room for `capacity` elements, `count` is NULL or writable.
    pub unsafe fn fill<T: Copy>(&self, elements: impl ExactSizeIterator<Item = T>) -> Result<()> {
        let length = elements.len();
        let stride = if self.stride == 0 { size_of::<T>() } else { self.stride };
        if self.buffer.is_null() && (self.capacity > 0 || self.count.is_null()) {
            out(self.buffer, "buffer")?;
        }
        if stride < size_of::<T>() {
            let problem = format!("a stride of {stride} bytes is less than the {} bytes of an element", size_of::<T>());
            return Err(Failure::new(InvalidArgument, problem));
        }
        if !self.buffer.is_null() {
            if self.capacity < length {
                let problem = format!(
                    "the buffer has room for {} elements, but there are {length}: ask for their number with a NULL buffer",
                    self.capacity
                );
                return Err(Failure::new(BufferTooSmall, problem));
            }
            for (i, element) in elements.enumerate() {
                // SAFETY: `i` is below the capacity, and elements need no alignment.
                unsafe {
                    copy_nonoverlapping((&raw const element).cast(), self.buffer.add(i * stride), size_of::<T>())
                };
            }
        }
        if !self.count.is_null() {
            // SAFETY: the caller's promise.
            unsafe { self.count.write(length) };
        }
        Ok(())
    }
}
