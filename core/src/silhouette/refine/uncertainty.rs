//! Standard deviation along a refined contour.

use super::{patch::Patch, trace::Loops};
use crate::{
    math::{min, sqrt},
    silhouette::refill::refill,
    sort,
    window::Window,
};
use alloc::{vec, vec::Vec};

/// Steps in a pixel of the stored standard deviations.
const UNITS: f32 = 32.0;

/// A pixel that the contour passes: its row, its column and the standard deviation, from the upper bits to the lower ones.
pub(super) type Passed = u64;

/// Standard deviation of a contour across itself, for every pixel that it passes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Uncertainty {
    /// For each row of the picture where its pixels start in the lists below, then one end.
    starts: Vec<u32>,
    columns: Vec<u16>,
    /// In 1/32 pixel, the largest of the pixel.
    sigmas: Vec<u8>,
}

impl Uncertainty {
    /// From a patch's loops and the variance of each of their points. Uses the memory of `old`; `found` is a buffer.
    pub(super) fn new(
        patch: &Patch,
        height: usize,
        loops: &Loops,
        variances: &[f32],
        old: Self,
        found: &mut Vec<Passed>,
    ) -> Self {
        found.clear();
        for (p, &variance) in loops.points.iter().zip(variances) {
            let (x, y) = (libm::floorf(p.x + 0.5), libm::floorf(p.y + 0.5));
            if x < 0.0 || y < 0.0 || x >= patch.width as f32 || y >= patch.height as f32 {
                continue;
            }
            let sigma = min(UNITS * sqrt(variance) + 0.5, 255.0) as u8;
            let (row, column) = ((patch.top + y as usize) as u32, (patch.left + x as usize) as u16);
            found.push(u64::from(row) << 24 | u64::from(column) << 8 | u64::from(sigma));
        }
        sort::numbers(found);
        let Self { mut starts, mut columns, mut sigmas } = old;
        refill(&mut starts, height + 1, 0);
        columns.clear();
        sigmas.clear();
        for (i, &passed) in found.iter().enumerate() {
            // Sorted: the last of a pixel's is its largest.
            if found.get(i + 1).is_some_and(|next| next >> 8 == passed >> 8) {
                continue;
            }
            columns.push((passed >> 8) as u16);
            sigmas.push(passed as u8);
            starts[(passed >> 24) as usize + 1] = columns.len() as u32;
        }
        for y in 0..height {
            starts[y + 1] = starts[y + 1].max(starts[y]);
        }
        Self { starts, columns, sigmas }
    }

    /// That of a window of the picture.
    pub(crate) fn window(&self, window: &Window) -> Self {
        let mut part = Self { starts: vec![0], ..Self::default() };
        let across = window.x..window.x + window.width;
        for rows in self.starts.windows(2).skip(window.y as usize).take(window.height as usize) {
            let passed = rows[0] as usize..rows[1] as usize;
            for (&column, &sigma) in self.columns[passed.clone()].iter().zip(&self.sigmas[passed]) {
                if across.contains(&u32::from(column)) {
                    part.columns.push(column - window.x as u16);
                    part.sigmas.push(sigma);
                }
            }
            part.starts.push(part.columns.len() as u32);
        }
        part
    }

    /// Standard deviation in pixels of the contour at a point of it: the mean over the pixels next to it that the
    /// contour passes; none if there are none.
    pub fn sigma(&self, u: f32, v: f32) -> Option<f32> {
        let (x, y) = (libm::floorf(u + 0.5) as i32, libm::floorf(v + 0.5) as i32);
        let (mut sum, mut count) = (0u32, 0u32);
        for row in y - 1..=y + 1 {
            if row < 0 || row as usize + 1 >= self.starts.len() {
                continue;
            }
            let range = self.starts[row as usize] as usize..self.starts[row as usize + 1] as usize;
            let columns = &self.columns[range.clone()];
            let first = columns.partition_point(|&c| i32::from(c) < x - 1);
            for (k, _) in columns[first..].iter().enumerate().take_while(|&(_, &c)| i32::from(c) <= x + 1) {
                sum += u32::from(self.sigmas[range.start + first + k]);
                count += 1;
            }
        }
        (count > 0).then(|| sum as f32 / (count as f32 * UNITS))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_keeps_the_deviations_of_its_pixels() {
        // The contour passes each row at two pixels.
        let height = 20u32;
        let columns = (0..height as u16).flat_map(|y| [3 + y % 5, 20 - y % 3]).collect();
        let sigmas = (0..2 * height as u8).map(|i| 8 + i).collect();
        let whole = Uncertainty { starts: (0..=height).map(|y| 2 * y).collect(), columns, sigmas };
        let window = Window { x: 4, y: 6, width: 12, height: 9 };
        let part = whole.window(&window);
        let mut passed = 0;
        // Pixels at the edge have neighbours outside of the window.
        for (u, v) in (1..11).flat_map(|u| (1..8).map(move |v| (u as f32, v as f32))) {
            let expected = whole.sigma(u + window.x as f32, v + window.y as f32);
            assert_eq!(part.sigma(u, v), expected, "pixel {u} {v}");
            passed += u32::from(expected.is_some());
        }
        assert!(passed > 10, "{passed}");
    }
}
