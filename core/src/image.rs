//! Pictures as the host passes them in: borrowed 8-bit pixels with a stride.

use alloc::{format, string::String, vec::Vec};

/// Layout of a picture's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum PixelFormat {
    /// One byte per pixel.
    Gray8 = 0,
    /// Red, green, blue.
    Rgb8 = 1,
    /// Blue, green, red.
    Bgr8 = 2,
    /// Red, green, blue and a byte that is ignored.
    Rgba8 = 3,
    /// Blue, green, red and a byte that is ignored.
    Bgra8 = 4,
    /// A luma plane and a half-size plane of interleaved Cb and Cr (ITU-R BT.601, video range).
    Nv12 = 5,
}

impl PixelFormat {
    /// Bytes between neighbouring pixels of the first plane.
    pub const fn bytes_per_pixel(self) -> usize {
        match self {
            Self::Gray8 | Self::Nv12 => 1,
            Self::Rgb8 | Self::Bgr8 => 3,
            Self::Rgba8 | Self::Bgra8 => 4,
        }
    }
}

/// A borrowed picture. The centre of the first pixel is at (0, 0), and rows run downwards.
#[derive(Debug, Clone, Copy)]
pub struct ImageRef<'a> {
    /// Bytes of the first plane.
    pub data: &'a [u8],
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Bytes from the start of one row to the start of the next.
    pub stride: usize,
    /// Layout of the bytes.
    pub format: PixelFormat,
    /// NV12 only: the plane of interleaved Cb and Cr, and its stride in bytes.
    pub chroma: Option<(&'a [u8], usize)>,
}

impl<'a> ImageRef<'a> {
    /// A picture without padding between its rows, in any format except NV12.
    pub fn packed(data: &'a [u8], width: u32, height: u32, format: PixelFormat) -> Self {
        Self { data, width, height, stride: width as usize * format.bytes_per_pixel(), format, chroma: None }
    }

    /// Checks that the buffers are large enough for the size, stride and format. The error states what does not fit.
    pub fn check(&self) -> Result<(), String> {
        let (w, h) = (self.width as usize, self.height as usize);
        if w == 0 || h == 0 {
            return Err(format!("the picture is {w} x {h} pixels: it is empty"));
        }
        let row = w * self.format.bytes_per_pixel();
        if self.stride < row {
            return Err(format!("the stride of {} bytes is smaller than a row of {row} bytes", self.stride));
        }
        if (h - 1) * self.stride + row > self.data.len() {
            return Err(format!(
                "{} bytes are too few for {w} x {h} pixels: the picture is truncated",
                self.data.len()
            ));
        }
        if self.format == PixelFormat::Nv12 {
            let (plane, stride) = self.chroma.ok_or_else(|| String::from("NV12 needs its chroma plane"))?;
            let (rows, row) = (h.div_ceil(2), w.div_ceil(2) * 2);
            if stride < row || (rows - 1) * stride + row > plane.len() {
                return Err(format!("{} bytes are too few for the chroma of {w} x {h} pixels", plane.len()));
            }
        }
        Ok(())
    }

    /// Red, green and blue of a pixel. Requires a picture that has passed [`Self::check`].
    #[inline]
    pub fn rgb(&self, x: u32, y: u32) -> [u8; 3] {
        let i = y as usize * self.stride + x as usize * self.format.bytes_per_pixel();
        let d = self.data;
        match self.format {
            PixelFormat::Gray8 => [d[i]; 3],
            PixelFormat::Rgb8 | PixelFormat::Rgba8 => [d[i], d[i + 1], d[i + 2]],
            PixelFormat::Bgr8 | PixelFormat::Bgra8 => [d[i + 2], d[i + 1], d[i]],
            PixelFormat::Nv12 => {
                let (plane, stride) = self.chroma.unwrap_or((&[128, 128], 0));
                let j = (y as usize / 2) * stride + (x as usize / 2) * 2;
                rgb_from_ycbcr(d[i], plane[j], plane[j + 1])
            }
        }
    }

    /// Brightness of a pixel (BT.601 luma). Masks are read this way.
    #[inline]
    pub fn gray(&self, x: u32, y: u32) -> u8 {
        luma(self.rgb(x, y))
    }

    /// All pixels as packed RGB.
    pub fn to_rgb(&self) -> Vec<u8> {
        let mut out = Vec::new();
        self.write_rgb(&mut out);
        out
    }

    /// Overwrites `out` with all pixels as packed RGB.
    pub(crate) fn write_rgb(&self, out: &mut Vec<u8>) {
        out.clear();
        out.reserve_exact(self.width as usize * self.height as usize * 3);
        for y in 0..self.height {
            if self.format == PixelFormat::Rgb8 {
                out.extend_from_slice(&self.data[y as usize * self.stride..][..self.width as usize * 3]);
            } else {
                out.extend((0..self.width).flat_map(|x| self.rgb(x, y)));
            }
        }
    }

    /// Overwrites `out` with the brightness of all pixels, packed.
    pub(crate) fn write_gray(&self, out: &mut Vec<u8>) {
        out.clear();
        out.reserve_exact(self.width as usize * self.height as usize);
        for y in 0..self.height {
            if self.format == PixelFormat::Gray8 {
                out.extend_from_slice(&self.data[y as usize * self.stride..][..self.width as usize]);
            } else {
                out.extend((0..self.width).map(|x| self.gray(x, y)));
            }
        }
    }
}

/// BT.601 luma in 0..=255.
#[inline]
pub fn luma([r, g, b]: [u8; 3]) -> u8 {
    ((u32::from(r) * 77 + u32::from(g) * 150 + u32::from(b) * 29 + 128) >> 8) as u8
}

/// The value at a place between the pixels of packed rows, interpolated bilinearly; `None` outside the picture.
#[inline]
pub(crate) fn bilinear<T: Copy + Into<f32>>(values: &[T], [width, height]: [usize; 2], x: f32, y: f32) -> Option<f32> {
    // Written so that NaN fails as well.
    if !(x >= 0.0 && y >= 0.0 && x < (width - 1) as f32 && y < (height - 1) as f32) {
        return None;
    }
    // Conversion to a signed integer is a single instruction, unlike conversion to `usize`.
    let (column, row) = (x as i32 as usize, y as i32 as usize);
    let (fx, fy) = (x - column as f32, y - row as f32);
    let v = &values[row * width + column..][..width + 2];
    let [a, b, c, d] = [v[0], v[1], v[width], v[width + 1]].map(Into::into);
    let (top, bottom) = (a + (b - a) * fx, c + (d - c) * fx);
    Some(top + (bottom - top) * fy)
}

/// BT.601, video range (16 to 235), in integer arithmetic so that the result is the same on every machine.
fn rgb_from_ycbcr(y: u8, cb: u8, cr: u8) -> [u8; 3] {
    let (y, cb, cr) = ((i32::from(y) - 16) * 298, i32::from(cb) - 128, i32::from(cr) - 128);
    let channel = |v: i32| ((v + 128) >> 8).clamp(0, 255) as u8;
    [channel(y + 409 * cr), channel(y - 100 * cb - 208 * cr), channel(y + 516 * cb)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nv12_is_bt601_video_range() {
        // Computed by hand: black, white and mid gray, then the primaries of BT.601 rounded to bytes.
        // Red 255 0 0 is Y 81.5, Cb 90.2, Cr 240.0; green Y 144.6, Cb 53.8, Cr 34.2; blue Y 41.0, Cb 240, Cr 109.8.
        let cases = [
            ([16, 128, 128], [0, 0, 0]),
            ([235, 128, 128], [255, 255, 255]),
            ([126, 128, 128], [128, 128, 128]),
            ([81, 90, 240], [254, 0, 0]),
            ([145, 54, 34], [0, 255, 1]),
            ([41, 240, 110], [0, 0, 255]),
        ];
        for ([y, cb, cr], rgb) in cases {
            for (a, b) in rgb_from_ycbcr(y, cb, cr).into_iter().zip(rgb) {
                assert!((i32::from(a) - b).abs() <= 1, "{y} {cb} {cr}: {a} {b}");
            }
        }
    }

    #[test]
    fn nv12_pixels_share_chroma_in_squares_and_strides_are_skipped() {
        // 3 x 3 pixels in rows of 4 bytes; the chroma plane has 2 x 2 pairs in rows of 6 bytes.
        let luma = [81, 81, 145, 9, 81, 81, 145, 9, 41, 41, 126];
        let chroma = [90, 240, 54, 34, 9, 9, 240, 110, 128, 128];
        let image = ImageRef {
            data: &luma,
            width: 3,
            height: 3,
            stride: 4,
            format: PixelFormat::Nv12,
            chroma: Some((&chroma, 6)),
        };
        image.check().unwrap();
        let (red, green, blue) =
            (rgb_from_ycbcr(81, 90, 240), rgb_from_ycbcr(145, 54, 34), rgb_from_ycbcr(41, 240, 110));
        let gray = rgb_from_ycbcr(126, 128, 128);
        let expected = [red, red, green, red, red, green, blue, blue, gray].concat();
        assert_eq!(image.to_rgb(), expected);
        assert!(ImageRef { chroma: Some((&chroma[..9], 6)), ..image }.check().is_err());
        assert!(ImageRef { chroma: None, ..image }.check().is_err());
        assert!(ImageRef { data: &luma[..10], ..image }.check().is_err());
    }

    #[test]
    fn formats_agree() {
        let rgb = [1, 2, 3, 40, 50, 60];
        let expected = rgb.to_vec();
        let packed = |data: &[u8], format| ImageRef::packed(data, 2, 1, format).to_rgb();
        assert_eq!(packed(&rgb, PixelFormat::Rgb8), expected);
        assert_eq!(packed(&[3, 2, 1, 60, 50, 40], PixelFormat::Bgr8), expected);
        assert_eq!(packed(&[1, 2, 3, 0, 40, 50, 60, 0], PixelFormat::Rgba8), expected);
        assert_eq!(packed(&[3, 2, 1, 0, 60, 50, 40, 0], PixelFormat::Bgra8), expected);
        assert_eq!(packed(&[7, 200], PixelFormat::Gray8), [7, 7, 7, 200, 200, 200]);
        let mut gray = Vec::new();
        ImageRef::packed(&[7, 200], 2, 1, PixelFormat::Gray8).write_gray(&mut gray);
        assert_eq!(gray, [7, 200]);
    }
}
