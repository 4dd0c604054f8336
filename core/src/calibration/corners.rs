//! Pixels whose surroundings are textured in two directions (Shi and Tomasi, Good Features to Track, CVPR 1994), so
//! that a match of them is sharp along and across its epipolar line.

use super::smooth::Smooth;
use alloc::{vec, vec::Vec};

/// Half the edge of the window in which gradients are summed.
const RADIUS: usize = 3;
/// There is at most one corner in each square cell of this many pixels.
const CELL: usize = 10;
/// Least root mean square of the gradient in its weakest direction, in grey levels per pixel.
const LEAST_GRADIENT: f32 = 1.2;
/// The same as a sum of squares over the window.
const LEAST: f32 = LEAST_GRADIENT * LEAST_GRADIENT * ((2 * RADIUS + 1) * (2 * RADIUS + 1)) as f32;
/// How far from a pixel its gradients are read.
pub(super) const AROUND: usize = RADIUS + 1;

/// The best corner of each cell in which there is one, row after row. `inside` tells whether a pixel is wanted.
pub(super) fn corners(picture: &Smooth, margin: usize, inside: impl Fn(usize) -> bool) -> Vec<[u16; 2]> {
    let (w, h) = (picture.width, picture.height);
    let border = margin.max(AROUND);
    if w <= 2 * border + 1 || h <= 2 * border + 1 {
        return Vec::new();
    }
    let (columns, rows) = (w.div_ceil(CELL), h.div_ceil(CELL));
    let mut best: Vec<(f32, [u16; 2])> = vec![(0.0, [0; 2]); columns * rows];
    // Sums of gradient products over the columns of the window, for each pixel of a row.
    let mut columns_of = vec![[0.0_f32; 3]; w];
    for y in border..h - border {
        let wanted = |x: usize| inside(y * w + x);
        let Some(first) = (border..w - border).find(|&x| wanted(x)) else { continue };
        let last = (border..w - border).rev().find(|&x| wanted(x)).unwrap_or(first);
        for x in first - RADIUS..=last + RADIUS {
            columns_of[x] = column(picture, x, y);
        }
        for x in (first..=last).filter(|&x| wanted(x)) {
            let weakest = weakest(&columns_of[x - RADIUS..=x + RADIUS]);
            let cell = &mut best[y / CELL * columns + x / CELL];
            if weakest > cell.0 {
                *cell = (weakest, [x as u16, y as u16]);
            }
        }
    }
    best.retain(|&(weakest, _)| weakest > LEAST);
    best.into_iter().map(|(_, at)| at).collect()
}

/// How much of a corner a pixel is: the sum of squared gradients around it in their weakest direction. `None` if that is too
/// little. The pixel must lie at least [`AROUND`] pixels inside the picture.
pub(super) fn strength(picture: &Smooth, x: usize, y: usize) -> Option<f32> {
    let columns: [[f32; 3]; 2 * RADIUS + 1] = core::array::from_fn(|i| column(picture, x + i - RADIUS, y));
    Some(weakest(&columns)).filter(|&weakest| weakest > LEAST)
}

/// Sums of gradient products over a column of the window around row `y`.
fn column(picture: &Smooth, x: usize, y: usize) -> [f32; 3] {
    let mut sums = [0.0; 3];
    for v in y - RADIUS..=y + RADIUS {
        let gx = 0.5 * (picture.at(x + 1, v) - picture.at(x - 1, v));
        let gy = 0.5 * (picture.at(x, v + 1) - picture.at(x, v - 1));
        sums[0] += gx * gx;
        sums[1] += gx * gy;
        sums[2] += gy * gy;
    }
    sums
}

/// The smaller eigenvalue of the sum of a window's columns.
fn weakest(columns: &[[f32; 3]]) -> f32 {
    let mut s = [0.0; 3];
    for sums in columns {
        (0..3).for_each(|k| s[k] += sums[k]);
    }
    let half = 0.5 * (s[0] + s[2]);
    let difference = 0.5 * (s[0] - s[2]);
    half - libm::sqrtf(difference * difference + s[1] * s[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_and_flat_parts_have_no_corners() {
        let (w, h) = (80, 60);
        let picture = |f: &dyn Fn(usize, usize) -> u8| {
            Smooth::new(&(0..w * h).map(|i| f(i % w, i / w)).collect::<Vec<u8>>(), w, h)
        };
        assert!(corners(&picture(&|_, _| 90), 8, |_| true).is_empty());
        let edge = |x: usize, y: usize| ((2.0 * x as f32 + y as f32 - 110.0) * 30.0 + 110.0).clamp(20.0, 200.0) as u8;
        assert!(corners(&picture(&edge), 8, |_| true).is_empty());
        let found = corners(&picture(&|x, y| if x > 40 && y > 30 { 200 } else { 20 }), 8, |_| true);
        assert!(!found.is_empty());
        for [x, y] in found {
            assert!(x.abs_diff(40) <= 4 && y.abs_diff(30) <= 4, "{x} {y}");
        }
    }
}
