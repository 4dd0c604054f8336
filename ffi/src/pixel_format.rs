//! How pixels are stored.

use pcmvs_core::PixelFormat;

/// Pixel formats. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_pixel_format {
    /// One byte per pixel.
    Gray8 = 0,
    /// Red, green, blue: three bytes per pixel.
    Rgb8 = 1,
    /// Blue, green, red: three bytes per pixel.
    Bgr8 = 2,
    /// Red, green, blue and a byte that is ignored.
    Rgba8 = 3,
    /// Blue, green, red and a byte that is ignored.
    Bgra8 = 4,
    /// A plane of luma and a plane of interleaved Cb, Cr at half the width and height, rounded up. `ycbcr` says how they code
    /// colours, as in the other formats with luma.
    Nv12 = 5,
    /// Two bytes per pixel in the machine's byte order. 65535 is white.
    Gray16 = 6,
    /// A plane of luma, a plane of Cb and a plane of Cr, the latter two at half the width and height, rounded up.
    I420 = 7,
    /// As NV12, but two bytes per value in the machine's byte order, of which the upper 10 bits count.
    P010 = 8,
    /// Luma, Cb, luma, Cr: four bytes for two neighbouring pixels. A row of odd width ends with such four bytes, too.
    Yuy2 = 9,
}

impl pcmvs_pixel_format {
    const ALL: [Self; 10] = [
        Self::Gray8,
        Self::Rgb8,
        Self::Bgr8,
        Self::Rgba8,
        Self::Bgra8,
        Self::Nv12,
        Self::Gray16,
        Self::I420,
        Self::P010,
        Self::Yuy2,
    ];

    /// The format with a number.
    pub(crate) fn new(number: u32) -> Option<Self> {
        Self::ALL.get(number as usize).copied()
    }

    /// The core's format in which a picture is handed on, unless it is converted to RGB.
    pub(crate) const fn of_core(self) -> PixelFormat {
        match self {
            Self::Gray8 | Self::Gray16 => PixelFormat::Gray8,
            Self::Bgr8 => PixelFormat::Bgr8,
            Self::Rgba8 => PixelFormat::Rgba8,
            Self::Bgra8 => PixelFormat::Bgra8,
            Self::Nv12 => PixelFormat::Nv12,
            Self::Rgb8 | Self::I420 | Self::P010 | Self::Yuy2 => PixelFormat::Rgb8,
        }
    }

    /// Bytes of a row of the first plane, and of a row of the planes of colour differences, of which there are up to two.
    pub(crate) const fn rows(self, width: usize) -> (usize, [Option<usize>; 2]) {
        let pairs = width.div_ceil(2);
        match self {
            Self::Gray8 => (width, [None; 2]),
            Self::Gray16 => (2 * width, [None; 2]),
            Self::Rgb8 | Self::Bgr8 => (3 * width, [None; 2]),
            Self::Rgba8 | Self::Bgra8 => (4 * width, [None; 2]),
            Self::Nv12 => (width, [Some(2 * pairs), None]),
            Self::I420 => (width, [Some(pairs), Some(pairs)]),
            Self::P010 => (2 * width, [Some(4 * pairs), None]),
            Self::Yuy2 => (4 * pairs, [None; 2]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_numbered() {
        for (number, format) in (0..).zip(pcmvs_pixel_format::ALL) {
            assert_eq!(format as u32, number);
        }
    }
}
