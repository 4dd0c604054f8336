//! The part of a picture in which its contour lies.

/// Pixels that a patch reaches beyond the silhouette's bounding box: colours of the background come from there.
const MARGIN: usize = 20;

/// A pixel is overexposed if its brightest channel is at least the first and its darkest at least the second.
const CLIPPED: [u8; 2] = [250, 230];

/// A rectangle of a picture: the silhouette's bounding box and some background around it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Patch<'a> {
    /// Left column and top row in the picture.
    pub left: usize,
    pub top: usize,
    pub width: usize,
    pub height: usize,
    /// Pixels in a row of the picture.
    stride: usize,
    /// Packed sRGB of the whole picture.
    rgb: &'a [u8],
}

impl<'a> Patch<'a> {
    /// The patch around all pixels that are at least half covered; none if there is no such pixel.
    pub fn around(width: usize, height: usize, rgb: &'a [u8], coverage: &[u8]) -> Option<Self> {
        let (mut left, mut right, mut top, mut bottom) = (width, 0, height, 0);
        for (y, row) in coverage.chunks_exact(width).enumerate() {
            let Some(first) = row.iter().position(|&c| c > 127) else { continue };
            let last = row.iter().rposition(|&c| c > 127).unwrap_or(first);
            (left, right) = (left.min(first), right.max(last + 1));
            (top, bottom) = (top.min(y), y + 1);
        }
        if right <= left {
            return None;
        }
        let (left, top) = (left.saturating_sub(MARGIN), top.saturating_sub(MARGIN));
        let (right, bottom) = ((right + MARGIN).min(width), (bottom + MARGIN).min(height));
        if right - left < 2 || bottom - top < 2 {
            return None;
        }
        Some(Self { left, top, width: right - left, height: bottom - top, stride: width, rgb })
    }

    /// Number of its pixels.
    pub fn len(&self) -> usize {
        self.width * self.height
    }

    /// Index in the picture of a pixel of the patch.
    #[inline]
    pub fn index(&self, x: usize, y: usize) -> usize {
        (self.top + y) * self.stride + self.left + x
    }

    /// Colour of a pixel of the patch.
    #[inline]
    pub fn bytes(&self, x: usize, y: usize) -> [u8; 3] {
        let p = &self.rgb[3 * self.index(x, y)..][..3];
        [p[0], p[1], p[2]]
    }

    /// Whether a pixel is overexposed: what was brighter than white looks like it.
    #[inline]
    pub fn is_clipped(&self, x: usize, y: usize) -> bool {
        let [r, g, b] = self.bytes(x, y);
        r.max(g).max(b) >= CLIPPED[0] && r.min(g).min(b) >= CLIPPED[1]
    }

    /// Colour of a pixel of the patch, as a vector.
    #[inline]
    pub fn colour(&self, x: usize, y: usize) -> [f32; 3] {
        self.bytes(x, y).map(f32::from)
    }
}
