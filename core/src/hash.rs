//! A 64-bit hash of a stage's output. It is the same on every platform.

/// A hash in the manner of FNV-1a with a step of its own: each 64-bit word is mixed in at once by an exclusive or and a
/// multiplication by FNV's 64-bit prime, and then the high bits are folded into the low ones by a shift. It is not
/// FNV-1a, which takes single bytes. It detects changes and is not cryptographic.
#[derive(Debug, Clone, Copy)]
pub struct Hash64(u64);

impl Default for Hash64 {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash64 {
    /// Mixes in a word.
    pub fn word(&mut self, v: u64) {
        self.0 = (self.0 ^ v).wrapping_mul(0x0000_0100_0000_01b3);
        self.0 ^= self.0 >> 29;
    }

    /// Mixes in the bits of a number; +0 and -0 give the same hash.
    pub fn number(&mut self, v: f32) {
        self.word(u64::from((v + 0.0).to_bits()));
    }

    /// The hash of parts whose own hashes are known, in their order.
    pub fn of_parts(parts: impl IntoIterator<Item = u64>) -> u64 {
        let mut hash = Self::default();
        parts.into_iter().for_each(|part| hash.word(part));
        hash.finish()
    }

    /// The hash so far.
    pub fn finish(self) -> u64 {
        self.0
    }
}
