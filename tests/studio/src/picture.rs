//! Pictures of the studio's cameras.

use pcmvs_core::{ImageRef, PixelFormat};

/// A packed 8-bit sRGB picture. A missing picture has no pixels.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Red, green and blue, by rows.
    pub rgb: Vec<u8>,
}

impl Picture {
    /// The picture as the core takes it.
    pub fn as_ref(&self) -> ImageRef<'_> {
        ImageRef::packed(&self.rgb, self.width, self.height, PixelFormat::Rgb8)
    }
}
