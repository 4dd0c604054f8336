//! Rows of bytes in the caller's memory.

use crate::{
    failure::{Failure, Result},
    status::pcmvs_status::{Image, NullPointer},
};
use std::{ffi::c_void, slice::from_raw_parts};

/// Rows of bytes from the top down. Rows that the caller stores from the bottom up are copied.
pub(crate) struct Plane<'a> {
    borrowed: &'a [u8],
    copied: Option<Vec<u8>>,
    /// Bytes from one row to the row below it.
    pub stride: usize,
}

impl Plane<'_> {
    /// Rows that have been converted.
    pub fn of(copied: Vec<u8>, stride: usize) -> Self {
        Self { borrowed: &[], copied: Some(copied), stride }
    }

    /// # Safety
    /// `data` is NULL or points to the top row of `rows` rows of `row` bytes that are `stride` bytes apart.
    pub unsafe fn new(data: *const c_void, rows: usize, row: usize, stride: isize, name: &str) -> Result<Self> {
        if data.is_null() {
            return Err(Failure::new(NullPointer, format!("`{name}` is NULL")));
        }
        let stride = if stride == 0 { row as isize } else { stride };
        let apart = stride.unsigned_abs();
        if apart < row {
            return Err(Failure::new(Image, format!("a stride of {stride} bytes is less than a row of {row}")));
        }
        let bytes =
            apart.checked_mul(rows - 1).and_then(|b| b.checked_add(row)).filter(|&b| isize::try_from(b).is_ok());
        let bytes = bytes.ok_or_else(|| Failure::new(Image, format!("{rows} rows of {row} bytes are too large")))?;
        let data: *const u8 = data.cast();
        // SAFETY: the caller's promise, and the sizes do not overflow.
        Ok(unsafe {
            if stride > 0 {
                Self { borrowed: from_raw_parts(data, bytes), copied: None, stride: apart }
            } else {
                let rows = (0..rows).flat_map(|y| from_raw_parts(data.offset(stride * y as isize), row));
                Self { borrowed: &[], copied: Some(rows.copied().collect()), stride: row }
            }
        })
    }

    pub fn bytes(&self) -> &[u8] {
        self.copied.as_deref().unwrap_or(self.borrowed)
    }

    /// The bytes from the start of a row on.
    pub fn row(&self, y: usize) -> &[u8] {
        &self.bytes()[y * self.stride..]
    }
}
