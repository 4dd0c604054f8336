//! The chunks of a GLB file.

use alloc::{string::String, vec::Vec};

const JSON_CHUNK: u32 = 0x4E4F_534A;
const BIN_CHUNK: u32 = 0x004E_4942;

/// Assembles the chunks. Each is padded to a multiple of four bytes: JSON with spaces and binary data with zeros.
pub(super) fn container(json: String, mut binary: Vec<u8>) -> Vec<u8> {
    let mut text = json.into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let chunks = [(JSON_CHUNK, &text), (BIN_CHUNK, &binary)];
    let chunks = chunks.iter().filter(|(_, bytes)| !bytes.is_empty());
    let length = 12 + chunks.clone().map(|(_, bytes)| 8 + bytes.len()).sum::<usize>();
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&(length as u32).to_le_bytes());
    for (kind, bytes) in chunks {
        out.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        out.extend_from_slice(&kind.to_le_bytes());
        out.extend_from_slice(bytes);
    }
    out
}
