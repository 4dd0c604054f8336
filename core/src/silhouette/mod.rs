//! Silhouettes (§0): which pixels see the object, with a contour finer than a pixel.

pub(crate) mod chroma;
pub(crate) mod clean_plate;
mod colour;
mod distance;
mod matte;
pub(crate) mod refine;

pub use chroma::ChromaKey;
pub(crate) use distance::SilhouetteScratch;
pub use refine::{ContourParams, Uncertainty};

use alloc::{format, string::String, vec::Vec};

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
    uncertainty: Option<Uncertainty>,
}

impl Silhouette {
    /// Marks a pixel outside the picture.
    pub const UNKNOWN: i16 = i16::MAX;
    /// Fixed-point units in a pixel.
    pub const UNITS: f32 = distance::UNITS;

    /// From coverage: one byte a pixel, 255 fully the object's, the contour where bilinear coverage is one half;
    /// `known` is false where an undistorted pixel has no source. Errors on an empty and on a full silhouette.
    pub fn from_coverage(
        width: u32,
        height: u32,
        coverage: &[u8],
        known: impl Fn(usize) -> bool,
    ) -> Result<Self, String> {
        Self::with_buffers(width, height, coverage, known, &mut SilhouetteScratch::default(), Vec::new())
    }

    /// [`Self::from_coverage`] with buffers to use; the distances go to `distance`.
    pub(crate) fn with_buffers(
        width: u32,
        height: u32,
        coverage: &[u8],
        known: impl Fn(usize) -> bool,
        scratch: &mut SilhouetteScratch,
        mut distance: Vec<i16>,
    ) -> Result<Self, String> {
        if width < 2 || height < 2 {
            return Err(format!("a silhouette of {width} x {height} pixels has no contour"));
        }
        distance::signed_distance(width as usize, height as usize, coverage, &known, scratch, &mut distance);
        let (mut inside, mut outside) = (false, false);
        for (i, d) in distance.iter_mut().enumerate() {
            if known(i) {
                inside |= *d > 0;
                outside |= *d <= 0;
            } else {
                *d = Self::UNKNOWN;
            }
        }
        if !inside {
            return Err(String::from(
                "the silhouette is empty: no pixel belongs to the object. Give a mask that is \
                white on the object, or null where there is none",
            ));
        }
        if !outside {
            return Err(String::from(
                "the silhouette is full: every pixel belongs to the object. Give a mask that is \
                black on the background, or null where there is none",
            ));
        }
        Ok(Self { width, height, distance, uncertainty: None })
    }

    /// Signed distance in 1/64 pixel at each pixel's centre, row after row.
    pub fn distances(&self) -> &[i16] {
        &self.distance
    }

    /// The same with what is known of its contour's precision.
    pub(crate) fn with_uncertainty(self, uncertainty: Option<Uncertainty>) -> Self {
        Self { uncertainty, ..self }
    }

    /// Standard deviation of the contour across itself in pixels, at a point of it; none where it is not known, as for
    /// a silhouette that was taken as it was given.
    pub fn contour_sigma(&self, u: f32, v: f32) -> Option<f32> {
        self.uncertainty.as_ref()?.sigma(u, v)
    }

    /// Its memory, to be used again.
    pub(crate) fn into_distances(self) -> Vec<i16> {
        self.distance
    }

    /// Bilinear signed distance in pixels, positive inside; `None` where nothing is known.
    #[inline]
    pub fn sample(&self, u: f32, v: f32) -> Option<f32> {
        let (w, h) = (self.width as usize, self.height as usize);
        // Written so that NaN fails too.
        if !(u >= 0.0 && v >= 0.0 && u <= (w - 1) as f32 && v <= (h - 1) as f32) {
            return None;
        }
        // Signed conversions are one instruction.
        let (x, y) = ((u as i32).min(w as i32 - 2), (v as i32).min(h as i32 - 2));
        let (fx, fy) = (u - x as f32, v - y as f32);
        let d = &self.distance[y as usize * w + x as usize..][..w + 2];
        let corners = [d[0], d[1], d[w], d[w + 1]];
        if corners.contains(&Self::UNKNOWN) {
            return None;
        }
        let [a, b, c, e] = corners.map(f32::from);
        let top = a + (b - a) * fx;
        let bottom = c + (e - c) * fx;
        Some((top + (bottom - top) * fy) * (1.0 / Self::UNITS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const W: u32 = 96;
    const H: u32 = 80;

    /// Renders the area that a signed distance function makes positive: exact coverage (16 x 16 samples a pixel) or
    /// the pixel's centre alone.
    fn render(inside: impl Fn(f32, f32) -> f32, samples: u32) -> Vec<u8> {
        let place = |i: u32| (i as f32 + 0.5) / samples as f32 - 0.5;
        let pixel = |i: u32| {
            let (x, y) = ((i % W) as f32, (i / W) as f32);
            let hits = (0..samples * samples)
                .filter(|s| inside(x + place(s % samples), y + place(s / samples)) > 0.0)
                .count() as u32;
            (hits * 255 / (samples * samples)) as u8
        };
        (0..W * H).map(pixel).collect()
    }

    /// Largest error of the distance within `reach` of the contour, away from the picture's edge, where the contour
    /// of the picture ends but the function's goes on.
    fn worst(truth: impl Fn(f32, f32) -> f32, samples: u32, reach: f32) -> f32 {
        let silhouette = Silhouette::from_coverage(W, H, &render(&truth, samples), |_| true).unwrap();
        let mut worst = 0.0f32;
        for (i, &d) in silhouette.distances().iter().enumerate() {
            let (x, y) = ((i as u32 % W) as f32, (i as u32 / W) as f32);
            let edge = x.min(y).min(W as f32 - 1.0 - x).min(H as f32 - 1.0 - y);
            if truth(x, y).abs() < reach && edge > 2.0 * reach {
                worst = worst.max((f32::from(d) / Silhouette::UNITS - truth(x, y)).abs());
            }
        }
        worst
    }

    fn disc(radius: f32) -> impl Fn(f32, f32) -> f32 {
        move |x, y| radius - libm::hypotf(x - 47.3, y - 40.8)
    }

    fn half_plane(angle: f32) -> impl Fn(f32, f32) -> f32 {
        move |x, y| (x - 47.3) * libm::cosf(angle) + (y - 40.8) * libm::sinf(angle)
    }

    fn bar(angle: f32, width: f32) -> impl Fn(f32, f32) -> f32 {
        move |x, y| width / 2.0 - half_plane(angle)(x, y).abs()
    }

    #[test]
    fn distance_is_exact_to_a_tenth_of_a_pixel_with_soft_masks() {
        assert!(worst(disc(30.0), 16, 8.0) < 0.1);
        for k in 0..8 {
            let angle = k as f32 * 0.13;
            assert!(worst(half_plane(angle), 16, 8.0) < 0.1);
            assert!(worst(bar(angle, 3.0), 16, 8.0) < 0.1);
        }
    }

    #[test]
    fn distance_is_good_to_a_third_of_a_pixel_with_binary_masks() {
        assert!(worst(disc(30.0), 1, 8.0) < 0.37);
        for k in 0..8 {
            let angle = k as f32 * 0.13;
            assert!(worst(half_plane(angle), 1, 8.0) < 0.37);
            assert!(worst(bar(angle, 4.0), 1, 8.0) < 0.37);
        }
    }

    #[test]
    fn thin_bars_keep_their_width() {
        for width in [2.0, 3.0, 4.0] {
            // At 0° pixel centres alone cannot tell the width to better than half a pixel.
            for k in 1..8 {
                let truth = bar(k as f32 * 0.13, width);
                let silhouette = Silhouette::from_coverage(W, H, &render(&truth, 1), |_| true).unwrap();
                let (mut sum, mut count) = (0.0, 0.0f32);
                for (i, &d) in silhouette.distances().iter().enumerate() {
                    let (x, y) = ((i as u32 % W) as f32, (i as u32 / W) as f32);
                    let edge = x.min(y).min(W as f32 - 1.0 - x).min(H as f32 - 1.0 - y);
                    if (-3.0..-0.5).contains(&truth(x, y)) && edge > 5.0 {
                        sum += f32::from(d) / Silhouette::UNITS - truth(x, y);
                        count += 1.0;
                    }
                }
                assert!((sum / count).abs() < 0.07, "{width} {k}: each side is off by {}", sum / count);
            }
        }
    }

    #[test]
    fn picture_edge_and_unknown_pixels_make_no_contour() {
        // The object covers everything left of x = 47.3, up to three edges of the picture.
        let mut coverage = render(|x, _| 47.3 - x, 16);
        let check = |silhouette: &Silhouette, columns: core::ops::Range<u32>| {
            for i in (0..W * H).filter(|i| columns.contains(&(i % W))) {
                let d = f32::from(silhouette.distances()[i as usize]) / Silhouette::UNITS;
                let truth = 47.3 - (i % W) as f32;
                assert!((d - truth).abs() < 0.1, "{d} instead of {truth}");
            }
        };
        check(&Silhouette::from_coverage(W, H, &coverage, |_| true).unwrap(), 0..W);
        // Unknown columns at the left say "background": they must not cut the object.
        let known = |i: usize| i % W as usize >= 10;
        (0..coverage.len()).filter(|&i| !known(i)).for_each(|i| coverage[i] = 0);
        let silhouette = Silhouette::from_coverage(W, H, &coverage, known).unwrap();
        check(&silhouette, 10..W);
        assert_eq!(silhouette.sample(9.5, 20.0), None);
        assert_eq!(silhouette.sample(-0.1, 20.0), None);
        assert!(silhouette.sample(10.0, 20.0).is_some());
    }

    #[test]
    fn far_distances_are_euclidean() {
        // Four pixels wide dots: every pixel's distance is that to the nearest dot, whatever lies between.
        let dots = [(10.0, 12.0), (80.0, 30.0), (33.0, 70.0), (60.0, 60.0)];
        let truth = |x: f32, y: f32| {
            dots.iter().map(|d| 2.0 - libm::hypotf(x - d.0, y - d.1)).fold(f32::NEG_INFINITY, f32::max)
        };
        let silhouette = Silhouette::from_coverage(W, H, &render(truth, 16), |_| true).unwrap();
        for (i, &d) in silhouette.distances().iter().enumerate() {
            let t = truth((i as u32 % W) as f32, (i as u32 / W) as f32);
            assert!((f32::from(d) / Silhouette::UNITS - t).abs() < 0.4);
        }
    }

    #[test]
    fn empty_and_full_silhouettes_are_errors() {
        for value in [0, 255] {
            assert!(Silhouette::from_coverage(W, H, &[value; (W * H) as usize], |_| true).is_err());
        }
        let half = render(half_plane(0.0), 16);
        assert!(Silhouette::from_coverage(W, H, &half, |i| i % W as usize > 60).is_err(), "only object is known");
        assert!(Silhouette::from_coverage(W, H, &half, |i| (i % W as usize) < 30).is_err(), "only background is known");
    }
}
