//! Silhouettes (§0): which pixels see the object, with a contour finer than a pixel.

mod distance;

use alloc::{string::String, vec::Vec};

/// A view's silhouette as the signed distance to its contour.
///
/// Distances are in 1/64 pixel, positive inside, clamped to ±511 pixels. Pixels of which nothing is known hold
/// [`Silhouette::UNKNOWN`]: like everything beyond the picture's edge they carve nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    distance: Vec<i16>,
}

impl Silhouette {
    /// Marks a pixel outside the picture.
    pub const UNKNOWN: i16 = i16::MAX;
    /// Fixed-point units in a pixel.
    pub const UNITS: f32 = 64.0;

    /// From coverage: one byte a pixel, 255 fully the object's, the contour where bilinear coverage is one half;
    /// `known` is false where an undistorted pixel has no source. Errors on an empty and on a full silhouette.
    pub fn from_coverage(
        width: u32,
        height: u32,
        coverage: &[u8],
        known: impl Fn(usize) -> bool,
    ) -> Result<Self, String> {
        let inside = coverage.iter().enumerate().filter(|&(i, &c)| known(i) && c > 127).count();
        if inside == 0 {
            return Err(String::from(
                "the silhouette is empty: no pixel belongs to the object. Give a mask that is \
                white on the object, or null where there is none",
            ));
        }
        if inside == (0..coverage.len()).filter(|&i| known(i)).count() {
            return Err(String::from(
                "the silhouette is full: every pixel belongs to the object. Give a mask that is \
                black on the background, or null where there is none",
            ));
        }
        let mut distance = distance::signed_distance(width as usize, height as usize, coverage);
        for (i, d) in distance.iter_mut().enumerate() {
            if !known(i) {
                *d = Self::UNKNOWN;
            }
        }
        Ok(Self { width, height, distance })
    }

    /// Signed distance in 1/64 pixel at each pixel's centre, row after row.
    pub fn distances(&self) -> &[i16] {
        &self.distance
    }

    /// Bilinear signed distance in pixels, positive inside; `None` where nothing is known.
    #[inline]
    pub fn sample(&self, u: f32, v: f32) -> Option<f32> {
        let (w, h) = (self.width as usize, self.height as usize);
        // Written so that NaN fails too.
        if !(u >= 0.0 && v >= 0.0 && u <= (w - 1) as f32 && v <= (h - 1) as f32) {
            return None;
        }
        let (x, y) = ((u as usize).min(w - 2), (v as usize).min(h - 2));
        let (fx, fy) = (u - x as f32, v - y as f32);
        let i = y * w + x;
        let d = &self.distance;
        let corners = [d[i], d[i + 1], d[i + w], d[i + w + 1]];
        if corners.contains(&Self::UNKNOWN) {
            return None;
        }
        let [a, b, c, e] = corners.map(f32::from);
        let top = a + (b - a) * fx;
        let bottom = c + (e - c) * fx;
        Some((top + (bottom - top) * fy) * (1.0 / Self::UNITS))
    }
}
