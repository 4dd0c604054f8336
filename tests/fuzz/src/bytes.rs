//! Decisions from the fuzzer's bytes.

/// Numbers that a file may hold by mistake.
const EXTREMES: [f64; 16] =
    [0.0, 1e-300, 1e-30, 1e-6, 0.01, 0.5, 2.0, 90.0, 1e3, 1e5, 1e9, 1e19, 1e39, 1e300, f64::INFINITY, f64::NAN];

/// The bytes that have not been used. At the end everything is zero.
pub struct Bytes<'a>(pub &'a [u8]);

impl Bytes<'_> {
    /// Whether all bytes have been used.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The next byte.
    pub fn byte(&mut self) -> u8 {
        let (first, rest) = self.0.split_first().map_or((0, self.0), |(&first, rest)| (first, rest));
        self.0 = rest;
        first
    }

    /// A number below `n`, which is at most 256.
    pub fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }

    /// The next four bytes.
    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes([0; 4].map(|_: u8| self.byte()))
    }

    /// From -1 to 1.
    pub fn signed(&mut self) -> f64 {
        f64::from(self.byte()) / 127.5 - 1.0
    }

    /// A number of any size.
    pub fn number(&mut self) -> f64 {
        let kind = self.byte();
        let size = EXTREMES[usize::from(kind) % EXTREMES.len()];
        let size = if kind & 64 != 0 { 1.0 + self.signed() } else { size };
        if kind & 128 != 0 { -size } else { size }
    }
}
