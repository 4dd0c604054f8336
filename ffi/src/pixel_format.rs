//! How pixels are stored.

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
