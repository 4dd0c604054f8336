//! An attribute as glTF describes it.

use crate::export::put;
use alloc::{string::String, vec::Vec};

/// glTF's numbers of the components' types.
pub(super) const BYTE: u32 = 5120;
pub(super) const UNSIGNED_SHORT: u32 = 5123;
pub(super) const UNSIGNED_INT: u32 = 5125;
pub(super) const FLOAT: u32 = 5126;

/// An attribute of all vertices.
pub(super) struct Attribute {
    /// glTF's number of the component's type.
    pub component: u32,
    /// Whether integers stand for fractions of the type's largest value.
    pub normalised: bool,
    /// glTF's name of the type.
    pub kind: &'static str,
    /// Bytes from one vertex to the next, and how many of them are used.
    pub stride: usize,
    pub used: usize,
    pub bytes: Vec<u8>,
    /// The JSON members of the smallest and largest values, if they are stated.
    pub range: String,
    /// The filter of EXT_meshopt_compression by which readers get the values from the bytes.
    pub filter: Option<&'static str>,
}

impl Attribute {
    pub fn floats<const N: usize>(kind: &'static str, values: impl Iterator<Item = [f32; N]>) -> Self {
        let mut bytes = Vec::new();
        values.for_each(|v| put(&mut bytes, &v));
        Self {
            component: FLOAT,
            normalised: false,
            kind,
            stride: 4 * N,
            used: 4 * N,
            bytes,
            range: String::new(),
            filter: None,
        }
    }

    /// Unsigned numbers of 16 bits. Vertices are padded to a multiple of four bytes.
    pub fn shorts<const N: usize>(
        kind: &'static str,
        normalised: bool,
        values: impl Iterator<Item = [u16; N]>,
    ) -> Self {
        let (used, stride) = (2 * N, (2 * N).next_multiple_of(4));
        let mut bytes = Vec::new();
        for value in values {
            value.iter().for_each(|v| bytes.extend_from_slice(&v.to_le_bytes()));
            bytes.resize(bytes.len() + stride - used, 0);
        }
        Self { component: UNSIGNED_SHORT, normalised, kind, stride, used, bytes, range: String::new(), filter: None }
    }
}
