//! What of a silhouette a surface leaves uncovered.

use super::Silhouette;

/// Pixels count if they lie at least this far inside the silhouette, in pixels. Nearer to the contour the surface may miss them
/// because the contour is not exact.
const DEEP: f32 = 4.0;

/// Pixels well inside a silhouette before which there is no surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Uncovered {
    /// Their number.
    pub pixels: u32,
    /// Number of all pixels of the silhouette.
    pub of: u32,
}

impl Uncovered {
    /// Counts the pixels of a silhouette. `is_covered` tells for a column and a row whether the surface is seen there.
    pub fn count(silhouette: &Silhouette, is_covered: &dyn Fn(usize, usize) -> bool) -> Self {
        let mut counted = Self::default();
        if silhouette.is_full() {
            return counted;
        }
        let deep = (DEEP * Silhouette::UNITS) as i16;
        let rows = silhouette.distances().chunks_exact(silhouette.width as usize);
        for (y, row) in rows.enumerate() {
            for (x, &distance) in row.iter().enumerate() {
                let is_inside = distance > 0 && distance != Silhouette::UNKNOWN;
                counted.of += u32::from(is_inside);
                counted.pixels += u32::from(is_inside && distance >= deep && !is_covered(x, y));
            }
        }
        counted
    }

    /// Their share of the silhouette, 0 to 1.
    pub fn share(&self) -> f32 {
        self.pixels as f32 / self.of.max(1) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn pixels_well_inside_that_are_not_covered_are_counted() {
        let coverage: Vec<u8> = (0..40 * 30).map(|i| if i % 40 < 20 { 255 } else { 0 }).collect();
        let silhouette = Silhouette::from_coverage(40, 30, &coverage, |_| true).expect("half of the picture");
        let count = |is_covered: fn(usize, usize) -> bool| Uncovered::count(&silhouette, &is_covered);
        assert_eq!(count(|_, _| true), Uncovered { pixels: 0, of: 600 });
        assert_eq!(count(|x, _| x < 17).pixels, 0, "a seam along the contour");
        // The contour lies half a pixel beyond column 19, so that columns to 15 are at least four pixels inside.
        assert_eq!(count(|_, y| y >= 5).pixels, 5 * 16);
        assert!((count(|_, y| y >= 15).share() - 0.4).abs() < 1e-6);
        let full = Silhouette::from_coverage(40, 30, &[255; 40 * 30], |_| true).expect("all of the picture");
        assert_eq!(Uncovered::count(&full, &|_, _| false).pixels, 0, "it does not tell where the object ends");
    }
}
