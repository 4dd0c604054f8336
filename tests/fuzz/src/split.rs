//! Several files in the bytes of one input.

/// Separates files. Binary files have single zero bytes everywhere.
const BETWEEN: &[u8] = b"\0\xFF\0\xFE";

/// So many files. Those that the bytes do not have are empty.
pub fn files_between(mut rest: &[u8], count: usize) -> Vec<Vec<u8>> {
    let mut next = || {
        let end = rest.windows(BETWEEN.len()).position(|window| window == BETWEEN).unwrap_or(rest.len());
        let file = rest[..end].to_vec();
        rest = rest.get(end + BETWEEN.len()..).unwrap_or_default();
        file
    };
    (0..count).map(|_| next()).collect()
}
