//! Grey levels that do not fill the range of their file: cameras write 10 or 12 bits into 16, and programs write masks of 0
//! and 1.

use crate::png_file::{Pixels, Samples};
use pcmvs_core::PixelFormat;

/// The largest levels of 8, 10 and 12 bits. If no pixel of a file of 16 bits is brighter, only so many bits are used: a
/// photograph that uses all 16 has brighter pixels.
const FEWER_BITS: [u16; 3] = [(1 << 8) - 1, (1 << 10) - 1, (1 << 12) - 1];

/// The brightest level that the colours of a file of 16 bits have; 0 for a file of fewer bits.
pub fn brightest(pixels: &Pixels) -> u16 {
    let Samples::Sixteen(samples) = &pixels.samples else { return 0 };
    // The last of 2 or 4 channels is alpha.
    let colours = pixels.channels - usize::from(pixels.channels.is_multiple_of(2));
    samples.chunks_exact(pixels.channels).flat_map(|pixel| &pixel[..colours]).copied().max().unwrap_or(0)
}

/// The brightest level that pixels can have, of which the brightest one has the level `used`. For black pictures it is that of all
/// bits.
pub fn range(used: u16) -> u16 {
    FEWER_BITS.into_iter().find(|&bits| used > 0 && used <= bits).unwrap_or(u16::MAX)
}

/// Whether pictures whose brightest pixel has the level `used` so far may be of fewer than 16 bits.
pub fn may_be_of_fewer_bits(used: u16) -> bool {
    used == 0 || range(used) < u16::MAX
}

/// The nearest of 256 levels for one of `brightest` levels. With all 16 bits it is rounded as `into_rgb8` does.
pub fn to_byte(level: u16, brightest: u16) -> u8 {
    let brightest = u32::from(brightest);
    ((u32::from(level) * 255 + brightest / 2) / brightest) as u8
}

/// Makes a mask of two colours, black and a dark one, one of black and white. Programs number what they segment, and colour the
/// numbers by a palette.
pub fn stretch_mask(pixels: &mut [u8], format: PixelFormat) {
    let channels = match format {
        PixelFormat::Gray8 => 1,
        PixelFormat::Rgb8 => 3,
        _ => return,
    };
    let is_black = |pixel: &[u8]| pixel.iter().all(|&v| v == 0);
    let Some(other) = pixels.chunks_exact(channels).find(|pixel| !is_black(pixel)).map(<[u8]>::to_vec) else { return };
    // Darker than half, by the mean of its channels.
    let dark = other.iter().map(|&v| usize::from(v)).sum::<usize>() < 128 * channels;
    let two = pixels.chunks_exact(channels).all(|pixel| is_black(pixel) || *pixel == *other);
    if dark && two {
        pixels.chunks_exact_mut(channels).filter(|pixel| !is_black(pixel)).for_each(|pixel| pixel.fill(255));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(channels: usize, samples: &[u16]) -> Pixels {
        let width = (samples.len() / channels) as u32;
        Pixels { width, height: 1, channels, samples: Samples::Sixteen(samples.to_vec()) }
    }

    #[test]
    fn fewer_bits_are_recognised_by_the_brightest_level() {
        let cases = [
            (1, 255),
            (255, 255),
            (256, 1023),
            (1023, 1023),
            (1024, 4095),
            (4095, 4095),
            (4096, 65535),
            (65535, 65535),
        ];
        for (level, expected) in cases {
            assert_eq!(range(brightest(&pixels(1, &[0, level]))), expected, "{level}");
        }
        assert_eq!(range(brightest(&pixels(1, &[0, 0]))), u16::MAX);
        assert_eq!(brightest(&pixels(4, &[1000, 500, 3, u16::MAX])), 1000);
        for brightest in [255, 1023, 4095, u16::MAX] {
            assert_eq!([to_byte(0, brightest), to_byte(brightest, brightest)], [0, 255]);
        }
        assert_eq!(to_byte(2048, 4095), 128);
    }

    #[test]
    fn masks_of_numbers_become_black_and_white_and_others_stay() {
        let stretched = |mut pixels: Vec<u8>, format| {
            stretch_mask(&mut pixels, format);
            pixels
        };
        assert_eq!(stretched(vec![0, 1, 1, 0], PixelFormat::Gray8), [0, 255, 255, 0]);
        assert_eq!(stretched(vec![0, 0, 0, 128, 0, 0], PixelFormat::Rgb8), [0, 0, 0, 255, 255, 255]);
        for mask in [vec![0, 0], vec![0, 1, 2], vec![0, 200], vec![7, 9], vec![0, 255, 128]] {
            assert_eq!(stretched(mask.clone(), PixelFormat::Gray8), mask);
        }
    }
}
