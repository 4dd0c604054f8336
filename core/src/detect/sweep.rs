//! Sheet sweep: scores every sample of a tile of pixels against every neighbouring view.
//!
//! Sample i of a pixel lies where the inverse depth is `1/z = 1/g - i Δ`, g the pixel's guide depth: the samples with
//! the same i form a sheet that runs parallel to the guide surface, so windows follow its slant and its steps. A
//! neighbour sees the sheet at the homogeneous pixel `M r + e / z`, M r of the pixel's ray, e of the target's centre:
//! from sheet to sheet that only moves by `Δ e`. A window is warped once a sheet, its sums are shared by all pixels.

use super::level::Level;
use crate::math::inverse_sqrt;
use glam::Vec3;

/// Pixels along a tile's edge.
pub const TILE: usize = 16;
/// Pixels in a tile.
pub const TILE_PIXELS: usize = TILE * TILE;
/// Largest radius of the correlation window.
pub const MAX_RADIUS: usize = 5;
/// Row length of the buffers that hold a tile with its margin.
const PADDED: usize = TILE + 2 * MAX_RADIUS;
const PADDED_PIXELS: usize = PADDED * PADDED;

/// Added to the variances in grey levels squared: windows whose contrast is no more than noise do not correlate.
const NOISE_VARIANCE: f32 = 1.0;

/// Buffers and plane-independent moments of one tile of the target view.
pub struct Tile {
    radius: usize,
    /// Offset so that sums of products stay small: the tile's mean luma.
    mean: f32,
    /// One on the object, zero elsewhere, over the padded tile.
    weight: [f32; PADDED_PIXELS],
    /// Weighted luma of the target.
    target: [f32; PADDED_PIXELS],
    /// Inverse guide depth.
    guide: [f32; PADDED_PIXELS],
    /// Where a neighbour sees the guide: homogeneous pixels.
    seen: [[f32; PADDED_PIXELS]; 3],
    /// How `seen` moves from sheet to sheet.
    epipole: Vec3,
    /// Warped, weighted luma of a neighbour.
    warped: [f32; PADDED_PIXELS],
    /// Per pixel: 1 / Σw, Σwa and 1 / √(var a).
    inverse_count: [f32; TILE_PIXELS],
    sum: [f32; TILE_PIXELS],
    inverse_sigma: [f32; TILE_PIXELS],
    /// Per pixel: what the noise adds to Σ (b - b̄)².
    noise: [f32; TILE_PIXELS],
    /// Vertical sums of b, b², ab.
    columns: [[f32; PADDED]; 3],
}

impl Default for Tile {
    fn default() -> Self {
        Self {
            radius: 0,
            mean: 0.0,
            weight: [0.0; PADDED_PIXELS],
            target: [0.0; PADDED_PIXELS],
            guide: [0.0; PADDED_PIXELS],
            seen: [[0.0; PADDED_PIXELS]; 3],
            epipole: Vec3::ZERO,
            warped: [0.0; PADDED_PIXELS],
            inverse_count: [0.0; TILE_PIXELS],
            sum: [0.0; TILE_PIXELS],
            inverse_sigma: [0.0; TILE_PIXELS],
            noise: [0.0; TILE_PIXELS],
            columns: [[0.0; PADDED]; 3],
        }
    }
}

impl Tile {
    /// Reads the target's pixels round the tile at (x0, y0); `guide` is a depth a pixel, 0 where the pixel is not searched.
    pub fn load(&mut self, level: &Level, guide: &[f32], x0: usize, y0: usize, radius: usize) {
        self.radius = radius;
        let (w, h) = (level.camera.width as i32, level.camera.height as i32);
        let size = TILE + 2 * radius;
        let (mut total, mut count) = (0u32, 0u32);
        for y in 0..size {
            for x in 0..size {
                let (px, py) = ((x0 + x) as i32 - radius as i32, (y0 + y) as i32 - radius as i32);
                let known = px >= 0 && py >= 0 && px < w && py < h;
                let i = if known { (py * w + px) as usize } else { 0 };
                let own = known && level.inside[i] > 0 && guide[i] > 0.0;
                let k = y * PADDED + x;
                self.guide[k] = if own { 1.0 / guide[i] } else { 0.0 };
                self.weight[k] = if own { 1.0 } else { 0.0 };
                self.target[k] = if own { f32::from(level.luma[i]) } else { 0.0 };
                if own {
                    total += u32::from(level.luma[i]);
                    count += 1;
                }
            }
        }
        self.mean = if count > 0 { libm::floorf(total as f32 / count as f32) } else { 0.0 };
        for k in 0..PADDED_PIXELS {
            self.target[k] -= self.mean * self.weight[k];
        }
        self.moments();
    }

    /// Window sums that no plane changes.
    fn moments(&mut self) {
        let (r, size) = (self.radius, TILE + 2 * self.radius);
        for y in 0..TILE {
            let mut columns = [[0.0f32; PADDED]; 3];
            for dy in 0..=2 * r {
                let row = (y + dy) * PADDED;
                for x in 0..size {
                    let (a, w) = (self.target[row + x], self.weight[row + x]);
                    columns[0][x] += w;
                    columns[1][x] += a;
                    columns[2][x] += a * a;
                }
            }
            for x in 0..TILE {
                let window = |c: &[f32; PADDED]| c[x..=x + 2 * r].iter().fold(0.0, |s: f32, v| s + v);
                let (n, a, aa) = (window(&columns[0]), window(&columns[1]), window(&columns[2]));
                let i = y * TILE + x;
                self.inverse_count[i] = if n > 0.0 { 1.0 / n } else { 0.0 };
                self.sum[i] = a;
                // At least one pixel's noise, so that empty windows score 0.
                self.noise[i] = NOISE_VARIANCE * n.max(1.0);
                self.inverse_sigma[i] =
                    if n > 0.0 { inverse_sqrt((aa - a * a / n).max(0.0) + self.noise[i]) } else { 0.0 };
            }
        }
    }

    /// Prepares the sweep against a neighbour.
    pub fn face(&mut self, target: &Level, neighbour: &Level, x0: usize, y0: usize) {
        let (rows, offset) = neighbour.camera.projection();
        let size = TILE + 2 * self.radius;
        let c = target.camera.centre;
        self.epipole = Vec3::new(rows[0].dot(c), rows[1].dot(c), rows[2].dot(c)) + offset;
        for y in 0..size {
            for x in 0..size {
                let k = y * PADDED + x;
                let ray = target.camera.ray((x0 + x) as f32 - self.radius as f32, (y0 + y) as f32 - self.radius as f32);
                for axis in 0..3 {
                    self.seen[axis][k] = rows[axis].dot(ray) + self.epipole[axis] * self.guide[k];
                }
            }
        }
    }

    /// ZNCC in [-1, 1] of the tile's windows with the faced neighbour's, on the sheet `shift` = i Δ behind the guide.
    pub fn score(&mut self, neighbour: &Level, shift: f32, out: &mut [f32; TILE_PIXELS]) {
        let visible = self.warp(neighbour, self.epipole * shift);
        if !visible {
            out.fill(-1.0);
            return;
        }
        let (r, size) = (self.radius, TILE + 2 * self.radius);
        self.columns = [[0.0; PADDED]; 3];
        for y in 0..2 * r {
            self.accumulate(y, size);
        }
        for y in 0..TILE {
            self.accumulate(y + 2 * r, size);
            let row = &mut out[y * TILE..][..TILE];
            self.correlate(y, row);
            self.release(y, size);
        }
    }

    /// Fills `warped`; false if no pixel of the tile falls into the neighbour's picture.
    fn warp(&mut self, neighbour: &Level, shift: Vec3) -> bool {
        let (w, height) = (neighbour.camera.width as usize, neighbour.camera.height as usize);
        let size = TILE + 2 * self.radius;
        let limit = (w as f32 - 1.001, height as f32 - 1.001);
        let mut visible = false;
        let (mut us, mut vs) = ([0.0f32; PADDED], [0.0f32; PADDED]);
        for y in 0..size {
            let row = y * PADDED;
            let [seen_u, seen_v, seen_w] = &self.seen;
            let (seen_u, seen_v, seen_w) =
                (&seen_u[row..row + PADDED], &seen_v[row..row + PADDED], &seen_w[row..row + PADDED]);
            for x in 0..PADDED {
                let inverse = 1.0 / (seen_w[x] - shift.z);
                us[x] = (seen_u[x] - shift.x) * inverse;
                vs[x] = (seen_v[x] - shift.y) * inverse;
            }
            for x in 0..size {
                let (u, v) = (us[x], vs[x]);
                visible |= u >= 0.0 && v >= 0.0 && u <= limit.0 && v <= limit.1;
                // max before min: NaN becomes 0.
                let (u, v) = (u.max(0.0).min(limit.0), v.max(0.0).min(limit.1));
                let (px, py) = (u as u32 as usize, v as u32 as usize);
                let (fx, fy) = (u - px as f32, v - py as f32);
                let square = &neighbour.luma[py * w + px..][..w + 2];
                let (top, bottom) = (f32::from(square[0]), f32::from(square[w]));
                let top = top + (f32::from(square[1]) - top) * fx;
                let bottom = bottom + (f32::from(square[w + 1]) - bottom) * fx;
                self.warped[row + x] = (top + (bottom - top) * fy - self.mean) * self.weight[row + x];
            }
        }
        visible
    }

    fn accumulate(&mut self, y: usize, size: usize) {
        let row = y * PADDED;
        let (a, b) = (&self.target[row..row + PADDED], &self.warped[row..row + PADDED]);
        let [sums, squares, products] = &mut self.columns;
        for x in 0..size {
            sums[x] += b[x];
            squares[x] += b[x] * b[x];
            products[x] += a[x] * b[x];
        }
    }

    fn release(&mut self, y: usize, size: usize) {
        let row = y * PADDED;
        let (a, b) = (&self.target[row..row + PADDED], &self.warped[row..row + PADDED]);
        let [sums, squares, products] = &mut self.columns;
        for x in 0..size {
            sums[x] -= b[x];
            squares[x] -= b[x] * b[x];
            products[x] -= a[x] * b[x];
        }
    }

    fn correlate(&self, y: usize, out: &mut [f32]) {
        let mut windows = [[0.0f32; TILE]; 3];
        for (window, column) in windows.iter_mut().zip(&self.columns) {
            for dx in 0..=2 * self.radius {
                for x in 0..TILE {
                    window[x] += column[x + dx];
                }
            }
        }
        for x in 0..TILE {
            let i = y * TILE + x;
            let inverse = self.inverse_count[i];
            let b = windows[0][x];
            let covariance = windows[2][x] - self.sum[i] * b * inverse;
            let variance = (windows[1][x] - b * b * inverse).max(0.0);
            out[x] = covariance * self.inverse_sigma[i] * inverse_sqrt(variance + self.noise[i]);
        }
    }
}
