//! Photographs as the studio's cameras take them.

use pcmvs_core::{ImageRef, PixelFormat};

/// Packed 8-bit sRGB. A missing picture is 0 x 0.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Picture {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue; row after row.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// The picture as the core takes it.
    pub fn as_ref(&self) -> ImageRef<'_> {
        ImageRef::packed(&self.rgb, self.width, self.height, PixelFormat::Rgb8)
    }
}
