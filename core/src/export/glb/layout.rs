//! The binary chunk of a GLB file, and the parts of its JSON that describe it.

use super::{
    attribute::{Attribute, UNSIGNED_INT, UNSIGNED_SHORT},
    compress::Compress,
};
use alloc::{format, string::String, vec::Vec};
use core::fmt::Write;

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// The binary chunk under construction.
#[derive(Default)]
pub(super) struct Layout<'a> {
    pub binary: Vec<u8>,
    pub views: Vec<String>,
    pub accessors: Vec<String>,
    compress: Option<&'a dyn Compress>,
    /// Bytes of the buffer that readers decompress into.
    plain: usize,
}

impl<'a> Layout<'a> {
    /// Compresses everything but pictures, if a compressor is given.
    pub fn new(compress: Option<&'a dyn Compress>) -> Self {
        Self { compress, ..Self::default() }
    }

    /// Whether a compressor is given.
    pub fn is_compressed(&self) -> bool {
        self.compress.is_some()
    }

    /// The JSON of the buffers.
    pub fn buffers(&self) -> String {
        let stored = format!(r#"{{"byteLength":{}}}"#, self.binary.len());
        match self.compress {
            None => stored,
            // The second buffer has no bytes in the file.
            Some(_) => format!(
                r#"{stored},{{"byteLength":{},"extensions":{{"EXT_meshopt_compression":{{"fallback":true}}}}}}"#,
                self.plain
            ),
        }
    }

    /// Adds the bytes of an attribute. Returns the index of its accessor.
    pub fn put_attribute(&mut self, attribute: &Attribute, count: usize) -> usize {
        let Attribute { component, normalised, kind, stride, used, ref bytes, ref range, filter } = *attribute;
        let filter = filter.map_or_else(String::new, |name| format!(r#","filter":"{name}""#));
        let packed = self.compress.map(|by| (by.attributes(bytes, stride), format!(r#""ATTRIBUTES"{filter}"#)));
        let view = self.put_view(bytes, count, stride, packed, ARRAY_BUFFER, used != stride);
        self.accessor(view, component, normalised, kind, count, range)
    }

    /// Adds triangles. Returns the index of their accessor.
    pub fn put_triangles(&mut self, triangles: &[[u32; 3]], vertices: usize) -> usize {
        let corners = triangles.as_flattened();
        let mut bytes = Vec::with_capacity(corners.len() * 4);
        // The index 65535 is reserved for primitive restart. The largest index is therefore 65534, for 65535 vertices.
        let (component, stride) = if vertices <= usize::from(u16::MAX) {
            corners.iter().for_each(|&i| bytes.extend_from_slice(&(i as u16).to_le_bytes()));
            (UNSIGNED_SHORT, 2)
        } else {
            corners.iter().for_each(|&i| bytes.extend_from_slice(&i.to_le_bytes()));
            (UNSIGNED_INT, 4)
        };
        let packed = self.compress.map(|by| (by.triangles(triangles, vertices), r#""TRIANGLES""#.into()));
        let view = self.put_view(&bytes, corners.len(), stride, packed, ELEMENT_ARRAY_BUFFER, false);
        self.accessor(view, component, false, "SCALAR", corners.len(), "")
    }

    /// Adds the bytes of a picture. Returns the index of its buffer view.
    pub fn put_picture(&mut self, bytes: &[u8]) -> usize {
        let start = self.put(bytes);
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{}}}"#, bytes.len()));
        self.views.len() - 1
    }

    /// Adds bytes at the next multiple of four. Returns their place.
    fn put(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let start = self.binary.len();
        self.binary.extend_from_slice(bytes);
        start
    }

    /// Adds a buffer view. `packed` has its compressed bytes, and the JSON of the mode of their compression, which may be followed
    /// by a filter.
    fn put_view(
        &mut self,
        bytes: &[u8],
        count: usize,
        stride: usize,
        packed: Option<(Vec<u8>, String)>,
        target: u32,
        has_stride: bool,
    ) -> usize {
        let length = bytes.len();
        let mut tail = String::new();
        if has_stride {
            let _ = write!(tail, r#","byteStride":{stride}"#);
        }
        let _ = write!(tail, r#","target":{target}"#);
        let (buffer, start) = match packed {
            None => (0, self.put(bytes)),
            Some((packed, mode)) => {
                let (start, stored) = (self.put(&packed), packed.len());
                let _ = write!(
                    tail,
                    concat!(
                        r#","extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteOffset":{start},"#,
                        r#""byteLength":{stored},"byteStride":{stride},"count":{count},"mode":{mode}}}}}"#
                    ),
                    start = start,
                    stored = stored,
                    stride = stride,
                    count = count,
                    mode = mode,
                );
                let place = self.plain.next_multiple_of(4);
                self.plain = place + length;
                (1, place)
            }
        };
        self.views.push(format!(r#"{{"buffer":{buffer},"byteOffset":{start},"byteLength":{length}{tail}}}"#));
        self.views.len() - 1
    }

    fn accessor(
        &mut self,
        view: usize,
        component: u32,
        normalised: bool,
        kind: &str,
        count: usize,
        range: &str,
    ) -> usize {
        let normalised = if normalised { r#","normalized":true"# } else { "" };
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":{component}{normalised},"count":{count},"type":"{kind}"{range}}}"#
        ));
        self.accessors.len() - 1
    }
}
