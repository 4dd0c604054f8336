//! Text in arrays of fixed size.

use std::{
    ffi::c_char,
    fmt::{Display, Write},
};

/// Writes a text with its final zero; what does not fit is cut off between characters. Allocates nothing.
pub(crate) fn text<const N: usize>(text: impl Display) -> [c_char; N] {
    let mut buffer = Buffer { bytes: [0; N], length: 0 };
    // It fails where the text is cut off.
    let _ = write!(buffer, "{text}");
    buffer.bytes
}

struct Buffer<const N: usize> {
    bytes: [c_char; N],
    length: usize,
}

impl<const N: usize> Write for Buffer<N> {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        let room = text.len().min(N - 1 - self.length);
        let fitting = (0..=room).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0);
        for &byte in &text.as_bytes()[..fitting] {
            self.bytes[self.length] = byte as c_char;
            self.length += 1;
        }
        if fitting == text.len() { Ok(()) } else { Err(std::fmt::Error) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn text_is_cut_between_characters() {
        let cases = [("", ""), ("abc", "abc"), ("abcd", "abc"), ("abé", "ab"), ("aé", "aé"), ("ab\u{20ac}", "ab")];
        for (given, kept) in cases {
            let written = text::<4>(given);
            // SAFETY: the last byte is never written.
            assert_eq!(unsafe { CStr::from_ptr(written.as_ptr()) }.to_str(), Ok(kept));
        }
    }
}
