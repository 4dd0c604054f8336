//! Buffers that are used again.

use alloc::vec::Vec;

/// Makes a buffer `len` copies of a value. One that is too small is freed first, and its successor is not larger than
/// needed.
pub fn refill<T: Clone>(buffer: &mut Vec<T>, len: usize, value: T) {
    buffer.clear();
    if buffer.capacity() < len {
        *buffer = Vec::new();
        buffer.reserve_exact(len);
    }
    buffer.resize(len, value);
}
