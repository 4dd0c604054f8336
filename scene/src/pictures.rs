//! Decodes JPEG and PNG files to the same pixels on every machine.
//!
//! The JPEG standard leaves the rounding of the inverse transform to the decoder. Therefore the same decoder, without its
//! SIMD paths, is used everywhere.

use crate::{
    levels,
    png_file::{self, Pixels, Samples},
};
use image::{ImageFormat, metadata::Orientation};
use pcmvs_core::{ImageRef, PixelFormat};
use zune_jpeg::{
    JpegDecoder,
    zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions},
};

/// A decoded picture without padding.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    format: PixelFormat,
    pixels: Vec<u8>,
    /// Whether the levels are exactly those that a program wrote.
    exact: bool,
    /// The level of the brightest pixel of a file of 16 bits, and the level that was made white; 0 for other files.
    brightest: u16,
    white: u16,
}

impl Picture {
    /// A picture from pixels without padding.
    pub fn new(pixels: Vec<u8>, width: u32, height: u32, format: PixelFormat) -> Self {
        Self { width, height, format, pixels, exact: false, brightest: 0, white: 0 }
    }

    /// The picture as the core borrows it.
    pub fn view(&self) -> ImageRef<'_> {
        ImageRef::packed(&self.pixels, self.width, self.height, self.format)
    }

    /// The pixels without padding, in the picture's format.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The alpha channel as a mask, if any pixel is more than half transparent: the picture then is a cut-out of the
    /// object.
    pub fn alpha(&self) -> Option<Self> {
        if self.format != PixelFormat::Rgba8 || self.pixels.iter().skip(3).step_by(4).all(|&alpha| alpha >= 128) {
            return None;
        }
        let pixels = self.pixels.iter().skip(3).step_by(4).copied().collect();
        Some(Self::new(pixels, self.width, self.height, PixelFormat::Gray8))
    }

    /// The mask that a picture holds: its alpha channel if it is a cut-out of the object, otherwise its brightness. If it has
    /// only two colours, black and a dark one, as PNG files with masks of 0 and 1 have, the dark one is the object.
    pub fn into_mask(mut self) -> Self {
        if let Some(alpha) = self.alpha() {
            return alpha;
        }
        if self.exact {
            levels::stretch_mask(&mut self.pixels, self.format);
        }
        self
    }

    /// Decodes the bytes of a file. Pixels stay as they are stored: where EXIF asks to turn them, the calibration must be of the
    /// stored ones. If the sides do not tell that, it is an error. Errors name the problem and the remedy.
    pub fn decode(file: &[u8]) -> Result<Self, String> {
        Self::decode_among(file, 0)
    }

    /// Decodes a picture among others of the same kind of camera. `brightest` is the level of their brightest pixel
    /// ([`Self::brightest`]), so that a dark picture of 12 bits is not taken for one of 10.
    pub fn decode_among(file: &[u8], brightest: u16) -> Result<Self, String> {
        if is_jpeg(file)? { decode_jpeg(file) } else { decode_png(file, brightest) }
    }

    /// Whether a file is a PNG of 16 bits, whose levels depend on the pictures around it.
    pub fn has_16_bits(file: &[u8]) -> bool {
        // The depth stands in the first chunk, IHDR (PNG 3, §11.2.1).
        file.get(24) == Some(&16) && matches!(is_jpeg(file), Ok(false))
    }

    /// The level of the brightest pixel that its file of 16 bits had; 0 for other files.
    pub const fn brightest(&self) -> u16 {
        self.brightest
    }

    /// Whether [`Self::decode_among`] gives the same picture if the brightest pixel of all pictures has this level.
    pub fn is_right_among(&self, brightest: u16) -> bool {
        self.brightest == 0 || levels::range(self.brightest.max(brightest)) == self.white
    }

    /// Width and height of the picture that [`Self::decode`] gives, from the header alone. Both are those of the stored pixels:
    /// an orientation that EXIF asks for is not applied. A file that is cut off is an error. Errors name the problem and the
    /// remedy.
    pub fn size(file: &[u8]) -> Result<[u32; 2], String> {
        if is_jpeg(file)? {
            return jpeg_header(file).map(|(_, size)| size);
        }
        if !png_file::has_end(file) {
            return Err(damaged("its end is missing"));
        }
        png_header(file)
    }
}

/// Fails if EXIF asks to turn or mirror a picture and its sides do not tell whether it is calibrated as it is stored. They do
/// tell if turning exchanges them.
fn check_orientation(exif: Option<&[u8]>, [width, height]: [u32; 2]) -> Result<(), String> {
    use Orientation::{NoTransforms, Rotate90, Rotate90FlipH, Rotate270, Rotate270FlipH};
    let orientation = exif.and_then(Orientation::from_exif_chunk).unwrap_or(NoTransforms);
    let exchanges = matches!(orientation, Rotate90 | Rotate90FlipH | Rotate270 | Rotate270FlipH);
    if orientation == NoTransforms || (exchanges && width != height) {
        return Ok(());
    }
    Err(format!(
        "EXIF asks to turn or mirror the picture (orientation {}), and its size does not tell whether it is calibrated as it is \
         stored or as it is shown: remove the orientation, or turn the pixels if it is calibrated as it is shown",
        orientation.to_exif()
    ))
}

/// Whether a file is JPEG. Otherwise it is PNG.
fn is_jpeg(file: &[u8]) -> Result<bool, String> {
    match image::guess_format(file) {
        Ok(ImageFormat::Jpeg) => Ok(true),
        Ok(ImageFormat::Png) => Ok(false),
        _ if file.is_empty() => Err(String::from("the file is empty: export it again")),
        _ => Err(String::from("the file is neither JPEG nor PNG: convert it to one of them")),
    }
}

/// Most pixels of a picture, as of a camera's in the core. They are counted before memory is allocated.
const MOST_PIXELS: usize = 1 << 28;

fn damaged(why: impl std::fmt::Display) -> String {
    format!("the picture is damaged or truncated ({why}): export it again")
}

type Jpeg<'f> = JpegDecoder<ZCursor<&'f [u8]>>;

/// A decoder that has read the header of a complete file, and width and height.
fn jpeg_header(file: &[u8]) -> Result<(Jpeg<'_>, [u32; 2]), String> {
    // If a copy stopped shortly before the end, all blocks may be there, and only the missing end marker shows it.
    let scan = file.windows(2).rposition(|marker| marker == [0xFF, 0xDA]).unwrap_or(0);
    if !file[scan..].windows(2).any(|marker| marker == [0xFF, 0xD9]) {
        return Err(damaged("its end marker is missing"));
    }
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(usize::from(u16::MAX))
        .set_max_height(usize::from(u16::MAX))
        .jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(file), options);
    decoder.decode_headers().map_err(|e| damaged(e.to_string().trim()))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| damaged("it has no size"))?;
    if width.saturating_mul(height) > MOST_PIXELS {
        return Err(format!("the picture is {width} x {height} pixels: at most {MOST_PIXELS} can be used; scale it"));
    }
    let size = [width as u32, height as u32];
    check_orientation(decoder.exif().map(Vec::as_slice), size)?;
    Ok((decoder, size))
}

fn decode_jpeg(file: &[u8]) -> Result<Picture, String> {
    let (mut decoder, [width, height]) = jpeg_header(file)?;
    let pixels = decoder.decode().map_err(|e| damaged(e.to_string().trim()))?;
    Ok(Picture::new(pixels, width, height, PixelFormat::Rgb8))
}

fn png_header(file: &[u8]) -> Result<[u32; 2], String> {
    let (size, exif) = png_file::header(file).map_err(damaged)?;
    check_orientation(exif.as_deref(), size).map(|()| size)
}

fn decode_png(file: &[u8], brightest: u16) -> Result<Picture, String> {
    png_header(file)?;
    let decoded = png_file::decode(file).map_err(damaged)?;
    let own = levels::brightest(&decoded);
    let white = levels::range(own.max(brightest));
    let colour = |v: u16| levels::to_byte(v, white);
    let alpha = |v: u16| levels::to_byte(v, u16::MAX);
    let Pixels { width, height, channels, samples } = decoded;
    let (format, pixels) = match (samples, channels) {
        (Samples::Eight(gray), 1) => (PixelFormat::Gray8, gray),
        (Samples::Eight(gray), 2) => (PixelFormat::Rgba8, rgba_of(&gray, 2, |v| v, |v| v)),
        (Samples::Eight(rgb), 3) => (PixelFormat::Rgb8, rgb),
        (Samples::Eight(rgba), _) => (PixelFormat::Rgba8, rgba),
        (Samples::Sixteen(gray), 1) => (PixelFormat::Rgb8, gray.into_iter().flat_map(|v| [colour(v); 3]).collect()),
        (Samples::Sixteen(rgb), 3) => (PixelFormat::Rgb8, rgb.into_iter().map(colour).collect()),
        (Samples::Sixteen(samples), channels) => (PixelFormat::Rgba8, rgba_of(&samples, channels, colour, alpha)),
    };
    Ok(Picture { width, height, format, pixels, exact: true, brightest: own, white })
}

/// RGBA from pixels with 2 channels, grey and alpha, or 4, which are RGBA. Grey is red, green and blue at once.
fn rgba_of<T: Copy>(samples: &[T], channels: usize, colour: impl Fn(T) -> u8, alpha: impl Fn(T) -> u8) -> Vec<u8> {
    let [green, blue] = if channels == 4 { [1, 2] } else { [0, 0] };
    let rgba = |pixel: &[T]| [colour(pixel[0]), colour(pixel[green]), colour(pixel[blue]), alpha(pixel[channels - 1])];
    samples.chunks_exact(channels).flat_map(rgba).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{ColorType, ImageEncoder, codecs::png::PngEncoder};

    fn png(pixels: &[u8], format: ColorType) -> Vec<u8> {
        let mut file = Vec::new();
        PngEncoder::new(&mut file).write_image(pixels, 2, 1, format.into()).unwrap();
        file
    }

    fn decoded(pixels: &[u8], format: ColorType) -> Picture {
        Picture::decode(&png(pixels, format)).unwrap()
    }

    /// Pixels of 12 bits of which a dark camera uses 10: by itself it would become four times as bright.
    #[test]
    fn the_range_of_levels_is_that_of_all_pictures() {
        let file = |level: u16| png(&[0, level].map(u16::to_ne_bytes).concat(), ColorType::L16);
        let (dark, bright) = (file(800), file(3000));
        let alone = [&dark, &bright].map(|file| Picture::decode(file).unwrap());
        assert_eq!([alone[0].brightest(), alone[1].brightest()], [800, 3000]);
        for (picture, brightest, expected) in [(0, 1023, true), (0, 3000, false), (1, 800, true), (1, 5000, false)] {
            assert_eq!(alone[picture].is_right_among(brightest), expected, "{picture} among {brightest}");
        }
        let eight = png(&[1, 2], ColorType::L8);
        assert_eq!(Picture::decode(&eight).unwrap().brightest(), 0);
        assert!(Picture::decode(&eight).unwrap().is_right_among(3000));
        assert_eq!([&dark, &eight].map(|file| Picture::has_16_bits(file)), [true, false]);
        let last = |picture: Picture| *picture.pixels().last().unwrap();
        assert_eq!(last(Picture::decode(&dark).unwrap()), levels::to_byte(800, 1023));
        assert_eq!(last(Picture::decode_among(&dark, 3000).unwrap()), levels::to_byte(800, 4095));
        assert_eq!(last(Picture::decode_among(&bright, 3000).unwrap()), levels::to_byte(3000, 4095));
    }

    #[test]
    fn the_size_is_read_without_the_pixels_and_only_of_complete_files() {
        let mut file = png(&[1, 2, 3, 4, 5, 6], ColorType::Rgb8);
        for end in 0..file.len() - 8 {
            assert!(Picture::size(&file[..end]).is_err(), "{end}");
        }
        let data = file.windows(4).position(|kind| kind == b"IDAT").unwrap() + 4;
        file[data..data + 4].fill(0);
        assert!(Picture::decode(&file).is_err());
        assert_eq!(Picture::size(&file), Ok([2, 1]));
    }

    /// The smallest EXIF data with an orientation: a TIFF header and one entry.
    fn exif(orientation: u8) -> Vec<u8> {
        let mut data = b"MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0".to_vec();
        data.extend([orientation, 0, 0, 0, 0, 0, 0]);
        data
    }

    fn png_with_exif(orientation: u8, width: u32) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = PngEncoder::new(&mut file);
        encoder.set_exif_metadata(exif(orientation)).unwrap();
        encoder.write_image(&[0; 2], width, 2 / width, ColorType::L8.into()).unwrap();
        file
    }

    fn jpeg_with_exif(orientation: u8) -> Vec<u8> {
        let mut file = include_bytes!("../../cli/tests/data/waves.jpg").to_vec();
        let data = [b"Exif\0\0".to_vec(), exif(orientation)].concat();
        let length = (data.len() as u16 + 2).to_be_bytes();
        file.splice(2..2, [&[0xFF, 0xE1], &length[..], &data].concat());
        file
    }

    #[test]
    fn a_turn_that_exif_asks_for_is_refused_unless_the_sides_tell_of_it() {
        for orientation in 1..=8 {
            for file in [png_with_exif(orientation, 2), jpeg_with_exif(orientation)] {
                let (size, decoded) = (Picture::size(&file).map(drop), Picture::decode(&file).map(drop));
                assert_eq!(size, decoded);
                match size {
                    Ok(()) => assert!(matches!(orientation, 1 | 5..=8), "{orientation}"),
                    Err(problem) => assert!(problem.contains(&format!("(orientation {orientation})")), "{problem}"),
                }
            }
        }
        assert!(check_orientation(Some(&exif(6)), [4, 4]).is_err());
    }

    #[test]
    fn the_alpha_of_a_cut_out_is_its_mask_in_every_format() {
        let mask = Picture::new(vec![255, 0], 2, 1, PixelFormat::Gray8);
        // The colours of a cut-out say nothing: white, black, or those of the object.
        assert_eq!(decoded(&[9, 8, 7, 255, 0, 0, 0, 0], ColorType::Rgba8).into_mask(), mask);
        assert_eq!(decoded(&[255, 255, 255, 0], ColorType::La8).into_mask(), mask);
        let sixteen: Vec<u8> = [9u16, 8, 7, u16::MAX, 0, 0, 0, 0].iter().flat_map(|v| v.to_ne_bytes()).collect();
        assert_eq!(decoded(&sixteen, ColorType::Rgba16).into_mask(), mask);
    }

    #[test]
    fn sixteen_bits_become_the_same_levels_with_and_without_alpha() {
        let bytes = |values: &[u16]| values.iter().flat_map(|v| v.to_ne_bytes()).collect::<Vec<u8>>();
        for v in (0..=u16::MAX).step_by(61).chain([127, 128, 129, 255, 256, 384, 385, 65406, 65407, u16::MAX]) {
            let (r, g, b) = (v, v / 3, u16::MAX - v);
            let plain = decoded(&bytes(&[r, g, b, b, g, r]), ColorType::Rgb16);
            let opaque = decoded(&bytes(&[r, g, b, u16::MAX, b, g, r, u16::MAX]), ColorType::Rgba16);
            let gray = decoded(&bytes(&[g, b]), ColorType::L16);
            let opaque_gray = decoded(&bytes(&[g, u16::MAX, b, u16::MAX]), ColorType::La16);
            assert_eq!(plain.view().to_rgb(), opaque.view().to_rgb(), "{v}");
            assert_eq!(gray.view().to_rgb(), opaque_gray.view().to_rgb(), "{v}");
        }
    }

    #[test]
    fn opaque_pictures_are_no_cut_outs() {
        for (pixels, format) in [
            (&[255, 255, 255, 255, 0, 0, 0, 250][..], ColorType::Rgba8),
            (&[255, 255, 0, 255], ColorType::La8),
            (&[255, 0], ColorType::L8),
        ] {
            let picture = decoded(pixels, format);
            assert_eq!(picture.alpha(), None);
            let mask = picture.clone().into_mask();
            assert_eq!((mask.view().gray(0, 0), mask.view().gray(1, 0)), (255, 0));
        }
    }
}
