//! Silhouettes (§0): which pixels see the object, with sub-pixel contours.

pub(crate) mod chroma;
pub(crate) mod clean_plate;
mod colour;
mod contour;
mod contour_fault;
mod distance;
mod edge;
mod keying;
mod matte;
mod no_silhouette;
mod parts;
mod refill;
pub(crate) mod refine;
pub(crate) mod stored;
mod uncovered;

pub use chroma::{ChromaKey, MORE_COLOURS};
pub use contour_fault::ContourFault;
pub(crate) use contour_fault::beyond_usual;
pub(crate) use distance::SilhouetteScratch;
pub use edge::ContourEdge;
pub use no_silhouette::NoSilhouette;
pub(crate) use parts::{Connected, Parts};
pub use refine::{ContourParams, Uncertainty};
pub(crate) use uncovered::Uncovered;

use crate::window::Window;
use alloc::{
    string::{String, ToString},
    vec::Vec,
};

/// A view's silhouette, as the signed distance to its contour.
///
/// Distances are positive inside. Up to 256 pixels they are in 1/64 pixel. Beyond that one step is 4 pixels, rounded towards
/// the contour ([`Silhouette::units`]), so that no picture is too large for them. Pixels without a source hold
/// [`Silhouette::UNKNOWN`]. Like everything beyond the picture's edge, they do not carve the hull.
#[derive(Debug, Clone, PartialEq)]
pub struct Silhouette {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    distance: Vec<i16>,
    uncertainty: Option<Uncertainty>,
    full: bool,
}

impl Silhouette {
    /// Marks a pixel that has no source in the real picture.
    pub const UNKNOWN: i16 = i16::MAX;
    /// Fixed-point units per pixel.
    pub const UNITS: f32 = stored::UNITS;

    /// Signed distance in 1/64 pixel from the form in which [`Self::distances`] holds it.
    #[inline(always)]
    pub fn units(distance: i16) -> i32 {
        stored::units(distance)
    }

    /// Creates a silhouette from coverage: one byte per pixel, 255 for pixels that lie fully on the object. The contour
    /// is where the bilinear interpolation of the smoothed coverage is one half. `known` is false for undistorted
    /// pixels that have no source. Fails if no pixel belongs to the object. Every pixel may belong to it: the object then
    /// fills the picture, and the silhouette has no contour ([`Self::is_full`]).
    pub fn from_coverage(
        width: u32,
        height: u32,
        coverage: &[u8],
        known: impl Fn(usize) -> bool,
    ) -> Result<Self, String> {
        Self::with_buffers(width, height, coverage, known, &mut SilhouetteScratch::default(), Vec::new())
            .map_err(|problem| problem.to_string())
    }

    /// [`Self::from_coverage`] with scratch buffers. The distances use the memory of `distance`.
    pub(crate) fn with_buffers(
        width: u32,
        height: u32,
        coverage: &[u8],
        known: impl Fn(usize) -> bool,
        scratch: &mut SilhouetteScratch,
        mut distance: Vec<i16>,
    ) -> Result<Self, NoSilhouette> {
        if width < 2 || height < 2 {
            return Err(NoSilhouette::TooSmall { width, height });
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
            return Err(NoSilhouette::Empty);
        }
        Ok(Self { width, height, distance, uncertainty: None, full: !outside })
    }

    /// Signed distance at the centre of each pixel, row after row: in 1/64 pixel up to 256 pixels ([`Self::units`]).
    pub fn distances(&self) -> &[i16] {
        &self.distance
    }

    /// Coverage of the silhouette with the marked pixels added to the object, and those next to them, whose colours are mixed.
    pub(crate) fn coverage_with(&self, added: &[bool]) -> Vec<u8> {
        let (w, h) = (self.width as usize, self.height as usize);
        let is_added = |x: usize, y: usize| {
            (y.saturating_sub(1)..(y + 2).min(h))
                .any(|y| (x.saturating_sub(1)..(x + 2).min(w)).any(|x| added[y * w + x]))
        };
        let pixel = |i: usize| {
            let inside = f32::from(self.distance[i]) / Self::UNITS + 0.5;
            if is_added(i % w, i / w) { 255 } else { (inside.clamp(0.0, 1.0) * 255.0) as u8 }
        };
        (0..w * h).map(pixel).collect()
    }

    /// The same silhouette with the marked pixels added to the object, and those next to them. Where nothing changes by more
    /// than a pixel, the contour remains exactly as it is.
    pub(crate) fn with_added(&self, added: &[bool], scratch: &mut SilhouetteScratch) -> Self {
        let (w, h) = (self.width as usize, self.height as usize);
        let coverage = self.coverage_with(added);
        let known = |i: usize| self.distance[i] != Self::UNKNOWN;
        let mut distance = Vec::new();
        distance::signed_distance(w, h, &coverage, &known, scratch, &mut distance);
        for (new, &old) in distance.iter_mut().zip(&self.distance) {
            if old == Self::UNKNOWN || (Self::units(*new) - Self::units(old)).abs() < Self::UNITS as i32 {
                *new = old;
            }
        }
        let full = distance.iter().all(|&d| d > 0);
        Self { distance, full, uncertainty: self.uncertainty.clone(), ..*self }
    }

    /// Marks the pixels outside the object that lie in gaps at most `2 * reach` pixels wide: those that remain outside if the
    /// object grows by `reach` and then shrinks by it.
    pub(crate) fn narrow(&self, reach: f32, scratch: &mut SilhouetteScratch) -> Vec<bool> {
        let reach = (reach * Self::UNITS) as i16;
        let grown: Vec<u8> = self.distance.iter().map(|&d| if d > -reach { 255 } else { 0 }).collect();
        let (w, h) = (self.width as usize, self.height as usize);
        let known = |i: usize| self.distance[i] != Self::UNKNOWN;
        let mut distance = Vec::new();
        distance::signed_distance(w, h, &grown, &known, scratch, &mut distance);
        distance.iter().zip(&self.distance).map(|(&grown, &d)| d <= 0 && grown > reach).collect()
    }

    /// Whether the object fills the picture: every pixel with a source belongs to it.
    pub fn is_full(&self) -> bool {
        self.full
    }

    /// Share of the picture's border that belongs to the object, 0 to 1. The border is the first and the last pixel
    /// with a source in each row and in each column.
    pub fn border_share(&self) -> f32 {
        let (w, h) = (self.width as usize, self.height as usize);
        let known = |&i: &usize| self.distance[i] != Self::UNKNOWN;
        let (mut inside, mut border) = (0u32, 0u32);
        let mut ends = |first: Option<usize>, last: Option<usize>| {
            for i in [first, last].into_iter().flatten() {
                border += 1;
                inside += u32::from(self.distance[i] > 0);
            }
        };
        for y in 0..h {
            let mut row = (0..w).map(|x| y * w + x).filter(known);
            ends(row.next(), row.next_back());
        }
        for x in 0..w {
            let mut column = (0..h).map(|y| y * w + x).filter(known);
            ends(column.next(), column.next_back());
        }
        inside as f32 / border.max(1) as f32
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

    /// A window of it.
    pub(crate) fn window(&self, window: &Window) -> Self {
        let uncertainty = self.uncertainty.as_ref().map(|whole| whole.window(window));
        let distance = window.of(&self.distance, self.width, 1);
        Self { width: window.width, height: window.height, distance, uncertainty, full: self.full }
    }

    /// The memory of the distances and of the contour's precision, for reuse.
    pub(crate) fn into_buffers(self) -> (Vec<i16>, Uncertainty) {
        (self.distance, self.uncertainty.unwrap_or_default())
    }

    /// Signed distance in pixels, interpolated bilinearly, positive inside. `None` where it is unknown.
    #[inline]
    pub fn sample(&self, u: f32, v: f32) -> Option<f32> {
        let (w, h) = (self.width as usize, self.height as usize);
        // Written so that NaN fails as well.
        if !(u >= 0.0 && v >= 0.0 && u <= (w - 1) as f32 && v <= (h - 1) as f32) {
            return None;
        }
        // Conversion to a signed integer is a single instruction, unlike conversion to `usize`.
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
        Some(stored::pixels(top + (bottom - top) * fy))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const W: u32 = 96;
    const H: u32 = 80;

    /// Renders the area in which a function is positive, with `samples` x `samples` samples per pixel: 16 give nearly
    /// exact coverage, and 1 gives a binary mask.
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

    /// Largest error of the distance within `reach` of the contour. Pixels near the picture's edge are excluded, because
    /// the silhouette's contour ends there but that of the function does not.
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
            // At 0° pixel centres determine the width only to half a pixel.
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
        // The unknown columns at the left look like background. They must not cut the object.
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
        // Dots four pixels wide: the distance of every pixel is that to the nearest dot.
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
    fn distances_are_right_across_the_largest_pictures() {
        // The object covers the first 40 columns of a picture with the longest side that is accepted.
        let (width, height) = (32768, 8);
        let coverage: Vec<u8> = (0..width * height).map(|i| if i % width < 40 { 255 } else { 0 }).collect();
        let silhouette = Silhouette::from_coverage(width, height, &coverage, |_| true).unwrap();
        for x in (0..width - 1).step_by(7).chain([width - 2]) {
            let (truth, found) = (39.5 - (x as f32 + 0.25), silhouette.sample(x as f32 + 0.25, 4.5).unwrap());
            let lost = truth.abs() - found.abs();
            assert!(
                (-0.02..if truth.abs() < 250.0 { 0.02 } else { 4.1 }).contains(&lost),
                "{found} instead of {truth}"
            );
        }
    }

    #[test]
    fn a_silhouette_may_fill_the_picture_but_not_be_empty() {
        assert!(Silhouette::from_coverage(W, H, &[0; (W * H) as usize], |_| true).is_err());
        let half = render(half_plane(0.0), 16);
        assert!(Silhouette::from_coverage(W, H, &half, |i| (i % W as usize) < 30).is_err(), "only background is known");
        let full = Silhouette::from_coverage(W, H, &[255; (W * H) as usize], |_| true).unwrap();
        assert!(full.is_full() && full.distances().iter().all(|&d| d > 0));
        let part = Silhouette::from_coverage(W, H, &half, |i| i % W as usize > 60).unwrap();
        assert!(part.is_full(), "only object is known");
        assert!(!Silhouette::from_coverage(W, H, &half, |_| true).unwrap().is_full());
    }

    #[test]
    fn the_border_belongs_to_the_object_where_it_touches_it() {
        let share = |truth: &dyn Fn(f32, f32) -> f32, known: &dyn Fn(usize) -> bool| {
            Silhouette::from_coverage(W, H, &render(truth, 4), known).unwrap().border_share()
        };
        assert_eq!(share(&disc(30.0), &|_| true), 0.0);
        assert_eq!(share(&|x, y| -disc(30.0)(x, y), &|_| true), 1.0);
        // The object covers the right half: one side, and half of two.
        let half = share(&half_plane(0.0), &|_| true);
        assert!((half - 0.5).abs() < 0.01, "{half}");
        // Beyond the first 60 columns nothing is known, so that the border is there.
        let known = share(&|x, _| 59.5 - x, &|i| i % (W as usize) < 60);
        assert_eq!(known, 1.0);
    }
}
