//! Compression of a GLB file's vertices and triangles.

use alloc::vec::Vec;

/// Compresses the vertices and triangles of a file by the algorithms of meshoptimizer, which the core does not have.
pub trait Compress {
    /// The bytes of the mode `ATTRIBUTES` of EXT_meshopt_compression. `bytes` has `stride` bytes per vertex, a multiple of
    /// four.
    fn attributes(&self, bytes: &[u8], stride: usize) -> Vec<u8>;
    /// The bytes of the mode `TRIANGLES` of EXT_meshopt_compression.
    fn triangles(&self, triangles: &[[u32; 3]], vertices: usize) -> Vec<u8>;
}
