//! Where the bytes of a clip's buffer views are.

use super::{
    document::{Buffer, BufferView, raw},
    shared::Shared,
};
use crate::fingerprint::sha256;
use serde_json::json;

/// The buffer views of a clip, and the size of its binary chunk.
#[derive(Default)]
pub struct Binary {
    views: Shared<BufferView>,
    /// Bytes of the chunk.
    stored: u64,
    /// Bytes of the buffer that readers decompress into. It is not in the file.
    plain: u64,
}

impl Binary {
    /// Adds a buffer view with its bytes as they are stored. Returns its index, and the place of the bytes in the chunk unless
    /// they are there already.
    pub fn add(&mut self, mut view: BufferView, bytes: &[u8]) -> (u32, Option<u64>) {
        view.byte_offset = 0;
        if let Some(extensions) = &mut view.extensions {
            extensions.compressed.byte_offset = 0;
        }
        let key = format!("{} {}", sha256(bytes), raw(&view));
        let (stored, plain) = (&mut self.stored, &mut self.plain);
        let mut added = None;
        let index = self.views.place(key, || {
            let place = take(stored, bytes.len() as u64);
            added = Some(place);
            match &mut view.extensions {
                Some(extensions) => {
                    extensions.compressed.byte_offset = place;
                    view.byte_offset = take(plain, view.byte_length);
                }
                None => view.byte_offset = place,
            }
            view
        });
        (index, added)
    }

    /// Bytes of the chunk, a multiple of four.
    pub fn size(&self) -> u64 {
        self.stored.next_multiple_of(4)
    }

    /// The buffers and the buffer views.
    pub fn into_parts(self) -> (Vec<Buffer>, Vec<BufferView>) {
        let mut buffers = vec![Buffer { byte_length: self.size(), extensions: None }];
        if self.plain > 0 {
            let extensions = Some(raw(&json!({ "EXT_meshopt_compression": { "fallback": true } })));
            buffers.push(Buffer { byte_length: self.plain, extensions });
        }
        (buffers, self.views.into_items())
    }
}

/// Reserves bytes at the next multiple of four. Returns their place.
fn take(end: &mut u64, length: u64) -> u64 {
    let place = end.next_multiple_of(4);
    *end = place + length;
    place
}
