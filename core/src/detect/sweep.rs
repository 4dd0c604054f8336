//! §4.1: a warped plane sweep (after Collins, A Space-Sweep Approach to True Multi-Image Matching, CVPR 1996). It
//! correlates every depth hypothesis of a tile of pixels with a neighbouring view.
//!
//! Hypothesis i of a pixel has the inverse depth `1/z = 1/g - i Δ`, where g is the pixel's guide depth. The hypotheses
//! of all pixels with the same i form a surface that is parallel to the guide surface, so that windows follow its slant
//! and its steps. A neighbour sees this surface at the homogeneous pixel `M r + e / z`, where `M r` is the projection
//! of the pixel's ray and e the epipole, the projection of the target's centre. From one hypothesis to the next this
//! only moves by `Δ e`. Each pixel is warped once per hypothesis, and sums over windows are shared by neighbouring
//! pixels (the running sums of Lewis, Fast Normalized Cross-Correlation, 1995, serve the same purpose).

use super::level::PyramidLevel;
use crate::{
    camera::Pinhole,
    math::{inverse_sqrt, max, split},
};
use core::ops::Range;
use glam::Vec3;

/// Pixels along the edge of a tile.
pub const TILE: usize = 16;
/// Pixels in a tile.
pub const TILE_PIXELS: usize = TILE * TILE;
/// Largest radius of the correlation window.
pub const MAX_RADIUS: usize = 4;
/// Row length of the buffers for a tile with its margin.
const WIDTH: usize = TILE + 2 * MAX_RADIUS;

/// Noise variance in squared grey levels, added to the variances of both windows. Windows with no more contrast than
/// noise therefore do not correlate.
pub const NOISE_VARIANCE: f32 = 1.0;

/// A row of a tile with its margin.
pub type Row = [f32; WIDTH];
pub const EMPTY: Row = [0.0; WIDTH];

/// One tile of the target view: buffers, and window sums that are the same for all hypotheses.
#[derive(Default)]
pub struct Tile {
    radius: usize,
    /// Rows with pixels to search. Only these are scored.
    rows: Range<usize>,
    /// Mean luma of the tile, which is subtracted so that sums of products remain small.
    mean: f32,
    /// 1 on the object and 0 elsewhere.
    weight: [Row; WIDTH],
    /// Weighted luma of the target.
    target: [Row; WIDTH],
    /// Inverse guide depth.
    guide: [Row; WIDTH],
    /// Homogeneous pixels at which a neighbour sees the guide surface.
    seen: [[Row; 3]; WIDTH],
    /// Displacement of `seen` per unit of inverse depth.
    epipole: Vec3,
    /// Warped, weighted luma of a neighbour.
    warped: [Row; WIDTH],
    /// Window sums of each row.
    moments: [Moments; TILE],
}

/// Window sums of a row that are the same for all hypotheses. With weights w, target luma a and neighbour luma b, they
/// are 1 / Σw, Σ wa, 1 / √(Σ w(a - ā)² + noise), and the noise term that is added to Σ w(b - b̄)².
#[derive(Default, Clone, Copy)]
struct Moments {
    inverse_count: [f32; TILE],
    sum: [f32; TILE],
    inverse_sigma: [f32; TILE],
    noise: [f32; TILE],
}

impl Tile {
    /// Loads the target's pixels around the tile at (x0, y0). `guide` is one depth per pixel, or 0 where a pixel is not
    /// searched.
    pub fn load(&mut self, level: &PyramidLevel, guide: &[f32], x0: usize, y0: usize, radius: usize) {
        debug_assert!(radius <= MAX_RADIUS);
        self.radius = radius;
        let (w, h) = (level.camera.width as i32, level.camera.height as i32);
        let size = TILE + 2 * radius;
        let (mut total, mut count) = (0u32, 0u32);
        let (mut first, mut last) = (TILE, 0);
        for y in 0..size {
            (self.guide[y], self.weight[y], self.target[y]) = (EMPTY, EMPTY, EMPTY);
            for x in 0..size {
                let (px, py) = ((x0 + x) as i32 - radius as i32, (y0 + y) as i32 - radius as i32);
                if px < 0 || py < 0 || px >= w || py >= h {
                    continue;
                }
                let i = (py * w + px) as usize;
                if level.inside[i] > 0 && guide[i] > 0.0 {
                    self.guide[y][x] = 1.0 / guide[i];
                    self.weight[y][x] = 1.0;
                    self.target[y][x] = f32::from(level.luma[i]);
                    total += u32::from(level.luma[i]);
                    count += 1;
                    let row = y.saturating_sub(radius).min(TILE - 1);
                    (first, last) = (first.min(row), last.max(row));
                }
            }
        }
        self.rows = first..last + 1;
        self.mean = (total / count.max(1)) as f32;
        for y in 0..size {
            for x in 0..WIDTH {
                self.target[y][x] -= self.mean * self.weight[y][x];
            }
        }
        self.sum_target();
    }

    /// Computes the window sums that are the same for all hypotheses.
    fn sum_target(&mut self) {
        let (r, size) = (self.radius, TILE + 2 * self.radius);
        for y in self.rows.clone() {
            let mut columns = [EMPTY; 3];
            for row in y..=y + 2 * r {
                for x in 0..size {
                    let (a, w) = (self.target[row][x], self.weight[row][x]);
                    columns[0][x] += w;
                    columns[1][x] += a;
                    columns[2][x] += a * a;
                }
            }
            let [count, sum, squares] = columns.map(|column| windows(&column, r));
            let moments = &mut self.moments[y];
            for x in 0..TILE {
                let (n, a) = (count[x], sum[x]);
                // The noise of at least one pixel, so that empty windows score 0.
                let noise = NOISE_VARIANCE * max(n, 1.0);
                let inverse = if n > 0.0 { 1.0 / n } else { 0.0 };
                moments.inverse_count[x] = inverse;
                moments.sum[x] = a;
                moments.noise[x] = noise;
                let variance = max(squares[x] - a * a * inverse, 0.0);
                moments.inverse_sigma[x] = if n > 0.0 { inverse_sqrt(variance + noise) } else { 0.0 };
            }
        }
    }

    /// Prepares the sweep for a neighbour.
    pub fn face(&mut self, target: &PyramidLevel, neighbour: &PyramidLevel, x0: usize, y0: usize) {
        let (rows, offset) = neighbour.camera.projection();
        let c = target.camera.centre;
        self.epipole = Vec3::new(rows[0].dot(c), rows[1].dot(c), rows[2].dot(c)) + offset;
        let (left, top) = (x0 as i32 - self.radius as i32, y0 as i32 - self.radius as i32);
        let (camera, epipole) = (target.camera, self.epipole);
        for y in self.rows.start..self.rows.end + 2 * self.radius {
            let (guide, seen, v) = (&self.guide[y], &mut self.seen[y], (top + y as i32) as f32);
            for x in 0..WIDTH {
                let ray = camera.ray((left + x as i32) as f32, v);
                for axis in 0..3 {
                    seen[axis][x] = rows[axis].dot(ray) + epipole[axis] * guide[x];
                }
            }
        }
    }

    /// ZNCC in [-1, 1] of the tile's windows with those of the neighbour that [`Self::face`] was called for, on the
    /// hypothesis at inverse depth `1/g - shift`. `pairs` are the neighbour's ([`PyramidLevel::write_pairs`]). Rows without pixels to search keep the previous content of `out`.
    #[inline(always)]
    pub fn score(&mut self, neighbour: &PyramidLevel, pairs: &[u16], shift: f32, out: &mut [f32; TILE_PIXELS]) {
        let shift = self.epipole * shift;
        let (r, rows) = (self.radius, self.rows.clone());
        let mut visible = false;
        for y in rows.start..rows.end + 2 * r {
            let (seen, weight) = (&self.seen[y], &self.weight[y]);
            visible |= warp(seen, shift, &neighbour.camera, pairs, self.mean, weight, &mut self.warped[y]);
        }
        if !visible {
            out.fill(-1.0);
            return;
        }
        // Running vertical sums of b, b² and ab.
        let mut columns = [EMPTY; 3];
        for y in rows.start..rows.start + 2 * r {
            accumulate(&mut columns, &self.target[y], &self.warped[y], 1.0);
        }
        for y in rows {
            accumulate(&mut columns, &self.target[y + 2 * r], &self.warped[y + 2 * r], 1.0);
            correlate(&columns, r, &self.moments[y], &mut out.as_chunks_mut().0[y]);
            accumulate(&mut columns, &self.target[y], &self.warped[y], -1.0);
        }
    }
}

/// Samples a neighbour's luma along a row bilinearly, subtracts `mean` and applies the weights. Returns false if no
/// pixel lies in its picture.
#[inline(always)]
fn warp(
    seen: &[Row; 3],
    shift: Vec3,
    neighbour: &Pinhole,
    pairs: &[u16],
    mean: f32,
    weight: &Row,
    out: &mut Row,
) -> bool {
    let (w, h) = (neighbour.width as usize, neighbour.height as usize);
    let (right, bottom) = (w as f32 - 1.001, h as f32 - 1.001);
    let (mut px, mut py) = ([0u32; WIDTH], [0u32; WIDTH]);
    let (mut fx, mut fy) = (EMPTY, EMPTY);
    let mut visible = 0;
    for x in 0..WIDTH {
        let inverse = 1.0 / (seen[2][x] - shift.z);
        let (u, v) = ((seen[0][x] - shift.x) * inverse, (seen[1][x] - shift.y) * inverse);
        visible |= u32::from(u >= 0.0) & u32::from(v >= 0.0) & u32::from(u <= right) & u32::from(v <= bottom);
        // Written so that NaN becomes 0.
        let (u, v) = (if u > 0.0 { u } else { 0.0 }, if v > 0.0 { v } else { 0.0 });
        (px[x], fx[x]) = split(if u < right { u } else { right });
        (py[x], fy[x]) = split(if v < bottom { v } else { bottom });
    }
    // Gathers the four pixels around each position, which are one word. Only this loop cannot be vectorised.
    let mut squares = [0u32; WIDTH];
    for x in 0..WIDTH {
        let square = &pairs[py[x] as usize * w + px[x] as usize..][..2];
        squares[x] = u32::from(square[0]) | u32::from(square[1]) << 16;
    }
    for x in 0..WIDTH {
        let pixel = |shift: u32| (squares[x] >> shift & 255) as i32 as f32;
        let (top, bottom) = (pixel(0), pixel(8));
        let top = top + (pixel(16) - top) * fx[x];
        let bottom = bottom + (pixel(24) - bottom) * fx[x];
        out[x] = (top + (bottom - top) * fy[x] - mean) * weight[x];
    }
    visible != 0
}

/// Adds a row to the vertical sums, or subtracts it (`sign` is 1 or -1).
#[inline(always)]
fn accumulate(columns: &mut [Row; 3], a: &Row, b: &Row, sign: f32) {
    let [sums, squares, products] = columns;
    for x in 0..WIDTH {
        let b_signed = b[x] * sign;
        sums[x] += b_signed;
        squares[x] += b[x] * b_signed;
        products[x] += a[x] * b_signed;
    }
}

/// Sums over windows, from vertical sums.
#[inline(always)]
pub fn windows(column: &Row, radius: usize) -> [f32; TILE] {
    let mut sums = [0.0; TILE];
    for dx in 0..=2 * radius {
        let part: &[f32; TILE] = column[dx..].first_chunk().expect("a row has a margin on both sides");
        for x in 0..TILE {
            sums[x] += part[x];
        }
    }
    sums
}

/// ZNCC of a row, from vertical sums.
#[inline(always)]
fn correlate(columns: &[Row; 3], radius: usize, moments: &Moments, out: &mut [f32; TILE]) {
    let [sum, squares, products] =
        [windows(&columns[0], radius), windows(&columns[1], radius), windows(&columns[2], radius)];
    for x in 0..TILE {
        let (b, inverse) = (sum[x], moments.inverse_count[x]);
        let covariance = products[x] - moments.sum[x] * b * inverse;
        let variance = max(squares[x] - b * b * inverse, 0.0);
        out[x] = covariance * moments.inverse_sigma[x] * inverse_sqrt(variance + moments.noise[x]);
    }
}
