//! A view's luma as matching reads it: smoothed a little, so that noise counts less and interpolation between pixels
//! blurs less.

use crate::image::bilinear;
use alloc::{vec, vec::Vec};
use glam::Vec2;

/// Luma smoothed with the weights 1 2 1 in both directions, in 1/16 of a grey level.
#[derive(Debug, Clone, Default)]
pub(super) struct Smooth {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) values: Vec<u16>,
}

impl Smooth {
    /// Smooths packed luma. Pixels of the border are repeated outside.
    pub(super) fn new(luma: &[u8], width: usize, height: usize) -> Self {
        let mut rows = vec![0_u16; width * height];
        for (line, out) in luma.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
            for x in 0..width {
                let [l, c, r] = [line[x.saturating_sub(1)], line[x], line[(x + 1).min(width - 1)]].map(u16::from);
                out[x] = l + 2 * c + r;
            }
        }
        let mut values = vec![0_u16; width * height];
        for y in 0..height {
            let [above, below] = [y.saturating_sub(1), (y + 1).min(height - 1)];
            for x in 0..width {
                values[y * width + x] = rows[above * width + x] + 2 * rows[y * width + x] + rows[below * width + x];
            }
        }
        Self { width, height, values }
    }

    /// Smooths the square of `2 * half + 1` pixels around a pixel, which is the middle of the result. `None` if the square
    /// reaches beyond the picture.
    pub(super) fn around(luma: &[u8], [width, height]: [usize; 2], [x, y]: [usize; 2], half: usize) -> Option<Self> {
        let fits = |at: usize, size: usize| (half..size.saturating_sub(half)).contains(&at);
        if !fits(x, width) || !fits(y, height) {
            return None;
        }
        let edge = 2 * half + 1;
        let row = |row: usize| &luma[(y - half + row) * width + x - half..][..edge];
        Some(Self::new(&(0..edge).flat_map(row).copied().collect::<Vec<u8>>(), edge, edge))
    }

    /// Interpolated bilinearly, in grey levels; `None` outside the picture.
    #[inline]
    pub(super) fn sample(&self, p: Vec2) -> Option<f32> {
        bilinear(&self.values, [self.width, self.height], p.x, p.y).map(|v| v * (1.0 / 16.0))
    }

    /// Value of a pixel in grey levels.
    #[inline]
    pub(super) fn at(&self, x: usize, y: usize) -> f32 {
        f32::from(self.values[y * self.width + x]) * (1.0 / 16.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_smoothed_as_the_whole_and_parts_beyond_the_picture_are_refused() {
        let (width, height) = (12, 9);
        let luma: Vec<u8> = (0..width * height).map(|i| (i * i * 7 % 251) as u8).collect();
        let whole = Smooth::new(&luma, width, height);
        let around = |at| Smooth::around(&luma, [width, height], at, 3);
        let part = around([8, 4]).unwrap();
        for (x, y) in (-2..=2).flat_map(|y| (-2..=2).map(move |x| (x, y))) {
            let at = |middle: usize, by: i32| middle.wrapping_add_signed(by as isize);
            assert_eq!(part.at(at(3, x), at(3, y)), whole.at(at(8, x), at(4, y)));
        }
        for beyond in [[2, 4], [9, 4], [8, 2], [8, 6], [usize::MAX, 4], [8, usize::MAX]] {
            assert!(around(beyond).is_none(), "{beyond:?}");
        }
    }
}
