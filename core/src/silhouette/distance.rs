//! Signed distance to the contour of a mask at half coverage, accurate to a fraction of a pixel.
//!
//! A vector distance transform in the manner of Danielsson (Euclidean Distance Mapping, 1980): each pixel holds the
//! offset to the nearest contour point found so far, and sweeps pass these points on to neighbouring pixels. Unlike
//! there, the contour points lie between pixels and the sweeps run along both axes.

use super::stored::{UNITS, stored};
use crate::{
    math::sqrt,
    simd::{Simd, Work},
};
use alloc::vec::Vec;

/// Weights of the binomial filter (σ = 0.7 pixel) that smooths the pixel staircase of a binary mask's contour. A wider
/// filter is not more accurate on straight contours, and it shortens fingers. With this one, bars of two and three
/// pixels keep their width.
const BINOMIAL: [u16; 3] = [1, 2, 1];
/// Smoothed coverage of one half: 255 · 4 · 4 / 2.
const HALF: u16 = 2040;
/// Offset of a pixel without a contour point. It remains larger than any valid offset when it is passed on.
const FAR: f32 = 1e6;

/// Signed distance in the form of [`stored`], positive where the smoothed coverage exceeds one half. `out` is overwritten.
///
/// There is no contour in cells with an unknown corner, nor along the picture's edge.
///
/// `known` is called at the contour only. It is not a type parameter, so that this is compiled once.
pub(super) fn signed_distance(
    width: usize,
    height: usize,
    coverage: &[u8],
    known: &dyn Fn(usize) -> bool,
    scratch: &mut SilhouetteScratch,
    out: &mut Vec<i16>,
) {
    let SilhouetteScratch { padded, half, smooth: smoothed, columns, rows } = scratch;
    smooth(width, height, coverage, padded, half, smoothed);
    columns.clear(height, width);
    seed(width, height, smoothed, known, columns);
    // The direction to the nearest contour point is within 45° of down, up, left or right. Therefore four sweeps find
    // it.
    sweep(columns);
    columns.transpose(rows);
    sweep(rows);
    out.resize(width * height, 0);
    Simd::detect().run(Measure { offsets: rows, smooth: smoothed, out });
}

/// Buffers that are reused for all views.
#[derive(Debug, Default)]
pub(crate) struct SilhouetteScratch {
    /// One row of coverage with its ends repeated.
    padded: Vec<u16>,
    /// Coverage smoothed along the rows only.
    half: Vec<u16>,
    smooth: Vec<u16>,
    columns: Offsets,
    rows: Offsets,
}

/// Coverage in 1/4080, smoothed by the binomial filter. The outermost pixels are repeated beyond the picture's edge.
fn smooth(
    width: usize,
    height: usize,
    coverage: &[u8],
    padded: &mut Vec<u16>,
    rows: &mut Vec<u16>,
    out: &mut Vec<u16>,
) {
    rows.resize(width * height, 0);
    padded.resize(width + 2, 0);
    for (row, out) in coverage.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        padded[0] = u16::from(row[0]);
        padded[width + 1] = u16::from(row[width - 1]);
        for (p, &c) in padded[1..].iter_mut().zip(row) {
            *p = u16::from(c);
        }
        for (o, p) in out.iter_mut().zip(padded.windows(3)) {
            *o = (0..3).map(|k| BINOMIAL[k] * p[k]).sum();
        }
    }
    out.clear();
    out.resize(width * height, 0);
    for (y, out) in out.chunks_exact_mut(width).enumerate() {
        for k in 0..3 {
            let row = &rows[(y + k).saturating_sub(1).min(height - 1) * width..][..width];
            for (o, r) in out.iter_mut().zip(row) {
                *o += BINOMIAL[k] * r;
            }
        }
    }
}

/// Cells in a row that are looked at together: most of them have no contour.
const CELLS: usize = 16;

/// Sets the offsets of the pixels around each segment of the contour. `offsets` is transposed.
fn seed(width: usize, height: usize, smooth: &[u16], known: &dyn Fn(usize) -> bool, offsets: &mut Offsets) {
    for y in 0..height - 1 {
        let (upper, lower) = (&smooth[y * width..][..width], &smooth[(y + 1) * width..][..width]);
        let with_contour = (0..width - 1).step_by(CELLS).map(|first| first..(first + CELLS).min(width - 1));
        let with_contour = with_contour.filter(|cells| {
            let inside = |row: &[u16]| row[cells.start..=cells.end].iter().map(|&s| u16::from(s > HALF)).sum::<u16>();
            let count = usize::from(inside(upper) + inside(lower));
            count > 0 && count < 2 * (cells.len() + 1)
        });
        for x in with_contour.flatten() {
            let inside = upper[x] > HALF;
            if inside == (upper[x + 1] > HALF) && inside == (lower[x] > HALF) && inside == (lower[x + 1] > HALF) {
                continue;
            }
            let i = y * width + x;
            if ![i, i + 1, i + width, i + width + 1].into_iter().all(known) {
                continue;
            }
            // The corners of the cell in order, and the points where the contour crosses the edges between them.
            let corners =
                [(upper[x], 0.0, 0.0), (upper[x + 1], 1.0, 0.0), (lower[x + 1], 1.0, 1.0), (lower[x], 0.0, 1.0)];
            let mut crossings = [(0.0f32, 0.0f32); 4];
            let mut count = 0;
            for k in 0..4 {
                let ((a, ax, ay), (b, bx, by)) = (corners[k], corners[(k + 1) % 4]);
                if (a > HALF) != (b > HALF) {
                    // The threshold is half a unit above HALF, so that no crossing coincides with a corner.
                    let (sa, sb) = (f32::from(a) - f32::from(HALF) - 0.5, f32::from(b) - f32::from(HALF) - 0.5);
                    let t = sa / (sa - sb);
                    crossings[count] = (x as f32 + ax + (bx - ax) * t, y as f32 + ay + (by - ay) * t);
                    count += 1;
                }
            }
            for pair in crossings[..count].chunks_exact(2) {
                for py in y.saturating_sub(1)..(y + 3).min(height) {
                    for px in x.saturating_sub(1)..(x + 3).min(width) {
                        let (dx, dy) = to_segment((px as f32, py as f32), pair[0], pair[1]);
                        offsets.improve(px * height + py, dy, dx);
                    }
                }
            }
        }
    }
}

/// Offset from a point to the nearest point of a segment.
fn to_segment(p: (f32, f32), a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 { (((p.0 - a.0) * dx + (p.1 - a.1) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    (a.0 + dx * t - p.0, a.1 + dy * t - p.1)
}

/// Offset of every pixel to the nearest contour point found so far.
#[derive(Debug, Default)]
struct Offsets {
    width: usize,
    x: Vec<f32>,
    y: Vec<f32>,
}

impl Offsets {
    /// Resets all pixels to having no contour point.
    fn clear(&mut self, width: usize, height: usize) {
        self.width = width;
        for offsets in [&mut self.x, &mut self.y] {
            offsets.clear();
            offsets.resize(width * height, FAR);
        }
    }

    fn improve(&mut self, i: usize, x: f32, y: f32) {
        if x * x + y * y < self.x[i] * self.x[i] + self.y[i] * self.y[i] {
            (self.x[i], self.y[i]) = (x, y);
        }
    }

    fn transpose(&self, out: &mut Self) {
        let (w, h) = (self.width, self.x.len() / self.width);
        out.width = h;
        transpose(w, h, &self.y, &mut out.x);
        transpose(w, h, &self.x, &mut out.y);
    }
}

/// Measures the offsets, in the form of [`stored`].
struct Measure<'a> {
    offsets: &'a Offsets,
    smooth: &'a [u16],
    out: &'a mut [i16],
}

impl Work for Measure<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Self { offsets: Offsets { x, y, .. }, smooth, out } = self;
        for (((out, &x), &y), &s) in out.iter_mut().zip(x).zip(y).zip(smooth) {
            let d = stored(sqrt(x * x + y * y) * UNITS + 0.5);
            *out = if s > HALF { d } else { -d };
        }
    }
}

/// Passes contour points on from row to row, first down and then up.
#[inline(never)]
fn sweep(offsets: &mut Offsets) {
    Simd::detect().run(Sweep(offsets));
}

/// The work of [`sweep`].
struct Sweep<'a>(&'a mut Offsets);

impl Work for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Offsets { width: w, x, y } = self.0;
        let (w, rows) = (*w, x.len() / *w);
        for r in 1..rows {
            let (from_x, x) = x[(r - 1) * w..][..2 * w].split_at_mut(w);
            let (from_y, y) = y[(r - 1) * w..][..2 * w].split_at_mut(w);
            hand_on(from_x, from_y, -1.0, x, y);
        }
        for r in (1..rows).rev() {
            let (x, from_x) = x[(r - 1) * w..][..2 * w].split_at_mut(w);
            let (y, from_y) = y[(r - 1) * w..][..2 * w].split_at_mut(w);
            hand_on(from_x, from_y, 1.0, x, y);
        }
    }
}

/// Pixels whose offsets are lowered together, which vectors hold.
const LANES: usize = 8;

/// Lowers the offsets of a row to those of each pixel's three neighbours in the row that is `step` below.
#[inline(always)]
fn hand_on(from_x: &[f32], from_y: &[f32], step: f32, x: &mut [f32], y: &mut [f32]) {
    let last = x.len() - 1;
    let mut first = 1;
    while first + LANES <= last {
        lower::<LANES>(first, [from_x, from_y], step, x, y);
        first += LANES;
    }
    for i in first..last {
        lower::<1>(i, [from_x, from_y], step, x, y);
    }
    for (i, j) in [(0, 1), (last, last - 1)] {
        for (from, across) in [(i, 0.0), (j, j as f32 - i as f32)] {
            let (dx, dy) = (from_x[from] + across, from_y[from] + step);
            if dx * dx + dy * dy < x[i] * x[i] + y[i] * y[i] {
                (x[i], y[i]) = (dx, dy);
            }
        }
    }
}

/// [`hand_on`] for N pixels from `first` on, none of which is the first or last of the row. Copies of the values show the
/// compiler that the rows do not overlap.
#[inline(always)]
fn lower<const N: usize>(first: usize, [from_x, from_y]: [&[f32]; 2], step: f32, x: &mut [f32], y: &mut [f32]) {
    let mut best_x: [f32; N] = copied(x, first);
    let mut best_y: [f32; N] = copied(y, first);
    for (from, across) in [(first, 0.0), (first - 1, -1.0), (first + 1, 1.0)] {
        let mut dx: [f32; N] = copied(from_x, from);
        let mut dy: [f32; N] = copied(from_y, from);
        for k in 0..N {
            (dx[k], dy[k]) = (dx[k] + across, dy[k] + step);
            let closer = dx[k] * dx[k] + dy[k] * dy[k] < best_x[k] * best_x[k] + best_y[k] * best_y[k];
            (best_x[k], best_y[k]) = (if closer { dx[k] } else { best_x[k] }, if closer { dy[k] } else { best_y[k] });
        }
    }
    x[first..first + N].copy_from_slice(&best_x);
    y[first..first + N].copy_from_slice(&best_y);
}

/// N values from `first` on.
#[inline(always)]
fn copied<const N: usize>(values: &[f32], first: usize) -> [f32; N] {
    let mut copy = [0.0; N];
    copy.copy_from_slice(&values[first..first + N]);
    copy
}

/// Transposes a plane, tile by tile: what a tile reads and writes remains in the cache.
fn transpose(width: usize, height: usize, plane: &[f32], out: &mut Vec<f32>) {
    const TILE: usize = 32;
    out.resize(plane.len(), 0.0);
    for first_y in (0..height).step_by(TILE) {
        for first_x in (0..width).step_by(TILE) {
            for x in first_x..(first_x + TILE).min(width) {
                for y in first_y..(first_y + TILE).min(height) {
                    out[x * height + y] = plane[y * width + x];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_of_any_size_are_transposed() {
        for (width, height) in [(1, 1), (16, 32), (15, 33), (40, 7)] {
            let plane: Vec<f32> = (0..width * height).map(|i| i as f32).collect();
            let (mut columns, mut back) = (Vec::new(), Vec::new());
            transpose(width, height, &plane, &mut columns);
            assert!(
                (0..plane.len()).all(|i| columns[i % width * height + i / width] == plane[i]),
                "{width} x {height}"
            );
            transpose(height, width, &columns, &mut back);
            assert_eq!(back, plane);
        }
    }
}
