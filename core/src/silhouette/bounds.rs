//! The rectangle of a picture in which its object lies.

/// A rectangle of pixels of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Bounds {
    /// Left column and top row.
    pub left: usize,
    pub top: usize,
    /// Size in pixels, at least 1 x 1.
    pub width: usize,
    pub height: usize,
}

impl Bounds {
    /// The bounds of all pixels that are at least half covered. `None` if there is no such pixel.
    pub fn of_object(width: usize, coverage: &[u8]) -> Option<Self> {
        let (mut left, mut right, mut top, mut bottom) = (width, 0, None, 0);
        for (y, row) in coverage.chunks_exact(width).enumerate() {
            let is_inside = |&c: &u8| c > 127;
            // The maximum of many pixels is found at once, and most rows of many pictures are empty.
            if !is_inside(&row.iter().fold(0, |largest, &c| largest.max(c))) {
                continue;
            }
            let first = row.iter().position(is_inside).unwrap_or(0);
            let last = row.iter().rposition(is_inside).unwrap_or(first);
            (left, right) = (left.min(first), right.max(last + 1));
            (top, bottom) = (top.or(Some(y)), y + 1);
        }
        top.map(|top| Self { left, top, width: right - left, height: bottom - top })
    }

    /// Grown by `margin` pixels on each side, within a picture of the given size.
    pub fn grown(&self, margin: usize, width: usize, height: usize) -> Self {
        let (left, top) = (self.left.saturating_sub(margin), self.top.saturating_sub(margin));
        let right = (self.left + self.width + margin).min(width);
        let bottom = (self.top + self.height + margin).min(height);
        Self { left, top, width: right - left, height: bottom - top }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_all_pixels_of_the_object() {
        let mut coverage = [127; 7 * 5];
        assert_eq!(Bounds::of_object(7, &coverage), None);
        coverage[2 * 7 + 4] = 128;
        let single = Bounds { left: 4, top: 2, width: 1, height: 1 };
        assert_eq!(Bounds::of_object(7, &coverage), Some(single));
        assert_eq!(single.grown(1, 7, 5), Bounds { left: 3, top: 1, width: 3, height: 3 });
        assert_eq!(single.grown(9, 7, 5), Bounds { left: 0, top: 0, width: 7, height: 5 });
        coverage[3 * 7 + 1] = 255;
        assert_eq!(Bounds::of_object(7, &coverage), Some(Bounds { left: 1, top: 2, width: 4, height: 2 }));
    }
}
