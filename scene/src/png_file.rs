//! Reads PNG files: grey or colour, with or without alpha, of 8 or 16 bits. Palettes and fewer bits are expanded.

use png::{Decoder, DecodingError, Limits, Reader, Transformations};
use std::io::Cursor;

/// Most bytes of the pixels of a file. They are counted before memory is allocated.
const MOST_BYTES: usize = 512 << 20;

/// The samples of all channels, pixel after pixel.
pub enum Samples {
    /// Of 8 bits.
    Eight(Vec<u8>),
    /// Of 16 bits.
    Sixteen(Vec<u16>),
}

/// Decoded pixels.
pub struct Pixels {
    pub width: u32,
    pub height: u32,
    /// 1 is grey, 2 grey and alpha, 3 red, green and blue, 4 these and alpha.
    pub channels: usize,
    pub samples: Samples,
}

/// Whether the chunks of a file lead to the one that ends it. A chunk has four bytes of length, four of type, its data and four
/// of a checksum (PNG 3, §5.3).
pub fn has_end(file: &[u8]) -> bool {
    let mut rest = file.get(8..).unwrap_or_default();
    while let Some((&[a, b, c, d, ref kind @ ..], _)) = rest.split_first_chunk::<8>() {
        if kind == b"IEND" {
            return true;
        }
        let next = u32::from_be_bytes([a, b, c, d]) as usize;
        rest = next.checked_add(12).and_then(|next| rest.get(next..)).unwrap_or_default();
    }
    false
}

/// Width and height, and EXIF data if there is any. Errors say what is wrong.
pub fn header(file: &[u8]) -> Result<([u32; 2], Option<Vec<u8>>), String> {
    let reader = reader(file).map_err(|e| e.to_string())?;
    let info = reader.info();
    Ok(([info.width, info.height], info.exif_metadata.as_ref().map(|exif| exif.to_vec())))
}

/// The pixels. Errors say what is wrong.
pub fn decode(file: &[u8]) -> Result<Pixels, String> {
    let mut reader = reader(file).map_err(|e| e.to_string())?;
    let size = reader.output_buffer_size().filter(|&size| size <= MOST_BYTES);
    let mut bytes = vec![0; size.ok_or("it has more pixels than can be used")?];
    let info = reader.next_frame(&mut bytes).map_err(|e| e.to_string())?;
    let samples = match info.bit_depth {
        png::BitDepth::Sixteen => {
            let sample = |pair: &[u8]| u16::from_be_bytes([pair[0], pair[1]]);
            Samples::Sixteen(bytes.chunks_exact(2).map(sample).collect())
        }
        _ => Samples::Eight(bytes),
    };
    Ok(Pixels { width: info.width, height: info.height, channels: info.color_type.samples(), samples })
}

/// A decoder that has read the header and expands palettes, samples of fewer than 8 bits and transparent colours.
fn reader(file: &[u8]) -> Result<Reader<Cursor<&[u8]>>, DecodingError> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(file), Limits { bytes: MOST_BYTES });
    decoder.set_ignore_text_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    decoder.read_info()
}
