//! Takes the place of the registry's crate of this name in this workspace, see `[patch.crates-io]` in the workspace's
//! Cargo.toml. The decoder of PNG needs that crate, whose tables of 16 KiB cannot be compressed and would be in each module
//! of the npm package. Here the table is that of the crate `crc`, whose size can be chosen: 1 KiB on WebAssembly.

use crc::{Algorithm, CRC_32_ISO_HDLC, Crc, NoTable, Table};

/// Number of tables of 1 KiB: as many bytes are processed at once.
const TABLES: usize = if cfg!(target_family = "wasm") { 1 } else { 16 };

static CHECKSUM: Crc<u32, Table<TABLES>> = Crc::<u32, Table<TABLES>>::new(&CRC_32_ISO_HDLC);
/// The same division without inversion before and after it, which makes it linear.
static DIVISION: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&Algorithm { init: 0, xorout: 0, ..CRC_32_ISO_HDLC });

/// The checksum of some bytes.
pub fn hash(bytes: &[u8]) -> u32 {
    CHECKSUM.checksum(bytes)
}

/// The checksum of bytes that are given in parts.
#[derive(Debug, Clone, Default)]
pub struct Hasher {
    sum: u32,
    length: u64,
}

impl Hasher {
    /// Of no bytes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Of bytes whose checksum is known.
    pub fn new_with_initial(sum: u32) -> Self {
        Self::new_with_initial_len(sum, 0)
    }

    /// Of bytes whose checksum and number are known.
    pub fn new_with_initial_len(sum: u32, length: u64) -> Self {
        Self { sum, length }
    }

    /// Appends bytes.
    pub fn update(&mut self, bytes: &[u8]) {
        // `crc` inverts the sum at the end, and takes the first one with its bits in the other order.
        let mut digest = CHECKSUM.digest_with_initial((!self.sum).reverse_bits());
        digest.update(bytes);
        self.sum = digest.finalize();
        self.length += bytes.len() as u64;
    }

    /// The checksum of all bytes so far.
    pub fn finalize(self) -> u32 {
        self.sum
    }

    /// Forgets all bytes.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Appends the bytes of another, as if they had been given to this one.
    pub fn combine(&mut self, other: &Self) {
        let mut digest = DIVISION.digest_with_initial(self.sum.reverse_bits());
        for _ in 0..other.length {
            digest.update(&[0]);
        }
        self.sum = digest.finalize() ^ other.sum;
        self.length += other.length;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_checksum_is_that_of_png() {
        // The chunk that ends each file.
        assert_eq!(hash(b"IEND"), 0xae42_6082);
        assert_eq!(hash(b"123456789"), 0xcbf4_3926);
        assert_eq!(hash(b""), 0);
    }

    proptest! {
        #[test]
        fn parts_have_the_checksum_of_the_whole(parts in proptest::collection::vec(any::<Vec<u8>>(), 0..5)) {
            let (mut updated, mut combined) = (Hasher::new(), Hasher::new());
            for part in &parts {
                updated.update(part);
                let mut other = Hasher::new();
                other.update(part);
                combined.combine(&other);
            }
            let whole = hash(&parts.concat());
            prop_assert_eq!(updated.finalize(), whole);
            prop_assert_eq!(combined.finalize(), whole);
        }

        #[test]
        fn a_known_checksum_is_continued(start: Vec<u8>, rest: Vec<u8>) {
            let mut hasher = Hasher::new_with_initial(hash(&start));
            hasher.update(&rest);
            prop_assert_eq!(hasher.finalize(), hash(&[start, rest].concat()));
        }
    }
}
