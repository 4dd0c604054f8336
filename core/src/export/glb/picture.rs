//! The picture of a texture in a GLB file.

use crate::texture::Texture;
use alloc::{format, string::String, vec::Vec};
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};

/// A texture as a file stores it. It is made before the file, so that programs which write no textures have no JPEG encoder.
pub(super) struct Picture<'a> {
    pub uvs: &'a [[f32; 2]],
    /// The bytes of a JPEG file.
    pub jpeg: Vec<u8>,
}

impl<'a> Picture<'a> {
    /// Encodes a texture. Colours have the full resolution, because a texel is about as large as a pixel of the photographs.
    pub fn new(texture: &'a Texture, quality: u8) -> Self {
        let mut jpeg = Vec::new();
        let mut encoder = Encoder::new(&mut jpeg, quality.clamp(1, 100));
        encoder.set_sampling_factor(SamplingFactor::F_1_1);
        encoder.set_optimized_huffman_tables(true);
        let size = texture.size as u16;
        encoder
            .encode(&texture.texels, size, size, ColorType::Rgb)
            .expect("a vector takes all bytes, and sizes of textures fit a JPEG file");
        Self { uvs: &texture.uvs, jpeg }
    }

    /// The JSON members that describe the picture in a buffer view. Charts do not reach the border of the picture, so that it
    /// needs no repetition.
    pub fn json(view: usize) -> String {
        const LINEAR: u32 = 9729;
        const LINEAR_MIPMAP_LINEAR: u32 = 9987;
        const CLAMP_TO_EDGE: u32 = 33071;
        format!(
            concat!(
                r#""textures":[{{"sampler":0,"source":0}}],"images":[{{"bufferView":{view},"mimeType":"image/jpeg"}}],"#,
                r#""samplers":[{{"magFilter":{mag},"minFilter":{min},"wrapS":{wrap},"wrapT":{wrap}}}],"#
            ),
            view = view,
            mag = LINEAR,
            min = LINEAR_MIPMAP_LINEAR,
            wrap = CLAMP_TO_EDGE,
        )
    }
}
