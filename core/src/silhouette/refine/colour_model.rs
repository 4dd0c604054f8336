//! Local colours of object and background along the contour, and the share of the object in a mixed pixel.
//!
//! In every cell of a coarse grid the two are separated by Fisher's linear discriminant of the colours around it. For
//! normal distributions of common covariance Σ this is the optimal one. With Δ = F - B the share of the object is
//! α = Δᵀ Σ⁻¹ (I - B) / J, J = Δᵀ Σ⁻¹ Δ, its variance is 1/J, and J (α - 1/2) is the logarithm of the likelihood ratio.
//! Directions in which the colours vary anyway, as brightness does on a lit screen, count little by themselves.

use super::{likelihoods::Likelihoods, patch::Patch};
use crate::silhouette::refill::refill;
use alloc::vec::Vec;

/// Edge of the cells in pixels.
pub(super) const CELL: usize = 4;
/// Weights of the cells around one, along each axis.
pub(super) const WINDOW: [f32; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
/// Weights of a wider surrounding, for places where the nearer one holds few pixels of a side.
const WIDE: [f32; 13] = [1.0; 13];
/// Smallest sum of weights for which the nearer surrounding is used.
const ENOUGH: f32 = 8.0;
/// Discriminants are needed this near to the contour, in 1/64 pixel.
const NEAR: u16 = 10 * 64;
/// Pixels whose colours are the other side's by this logarithm of the likelihood ratio hardly count, because the matte is
/// probably wrong there.
const FOREIGN: f32 = 1.5;
const FOREIGN_WEIGHT: f32 = 0.02;
/// Variance added to each channel for quantisation and compression.
const FLOOR: f32 = 9.0;
/// Number of sums: weight, three of colours, six of their products.
const SUMS: usize = 10;

/// Room for the weights by distance, in steps of 1/4 pixel.
pub(super) const WEIGHTS: usize = 64;

type Sums = [f32; SUMS];

/// How much a pixel counts for the colours of its side, by its distance from the assumed contour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trust {
    /// Nearer pixels do not count: they are mixed, or may belong to the other side.
    pub from: f32,
    /// Factor for every pixel of distance up to `full`: those that are more certain outweigh the others wherever there
    /// are any.
    pub growth: f32,
    pub full: f32,
    /// Farther pixels are not the contour's neighbours any more.
    pub to: f32,
}

impl Trust {
    /// Weights by distance in steps of 1/4 pixel. `room` is a buffer.
    pub fn weights<'r>(&self, room: &'r mut [f32; WEIGHTS]) -> &'r [f32] {
        let weights = &mut room[..(self.to * 4.0) as usize + 1];
        for (i, weight) in weights.iter_mut().enumerate() {
            let d = 0.25 * i as f32;
            *weight = if d >= self.from { libm::powf(self.growth, d.min(self.full) - self.full) } else { 0.0 };
        }
        weights
    }
}

/// α = `direction` · colour + `offset`, with precision `j`.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Discriminant {
    direction: [f32; 3],
    offset: f32,
    pub j: f32,
}

impl Discriminant {
    #[inline]
    pub fn alpha(&self, colour: [f32; 3]) -> f32 {
        let d = &self.direction;
        d[0] * colour[0] + d[1] * colour[1] + d[2] * colour[2] + self.offset
    }
}

/// The discriminants of a patch.
#[derive(Debug, Default)]
pub(super) struct ColourModel {
    columns: usize,
    rows: usize,
    cells: Vec<Discriminant>,
    /// Sums of background and object in every cell, and whether the cell has pixels near the contour.
    sides: [Vec<Sums>; 2],
    near: Vec<bool>,
}

impl ColourModel {
    /// Learns the colours of both sides of a contour, given by the signed distance to it in 1/64 pixel.
    pub fn learn(&mut self, patch: &Patch, distance: &[i16], colours: &Likelihoods, trust: Trust) {
        let (columns, rows) = (patch.width.div_ceil(CELL), patch.height.div_ceil(CELL));
        (self.columns, self.rows) = (columns, rows);
        self.sides.iter_mut().for_each(|side| refill(side, columns * rows, [0.0; SUMS]));
        refill(&mut self.near, columns * rows, false);
        refill(&mut self.cells, columns * rows, Discriminant::default());
        self.add_up(patch, distance, colours, trust);
        let Self { cells, sides, near, .. } = self;
        let side = |k: usize, i: usize| {
            let near = gather(&sides[k], columns, rows, i, &WINDOW);
            if near[0] >= ENOUGH { near } else { gather(&sides[k], columns, rows, i, &WIDE) }
        };
        // Pixels between two cells take their discriminant from both.
        let needed = |i: usize| {
            let (x, y) = (i % columns, i / columns);
            (y.saturating_sub(1)..(y + 2).min(rows))
                .any(|ny| (x.saturating_sub(1)..(x + 2).min(columns)).any(|nx| near[ny * columns + nx]))
        };
        for (i, cell) in cells.iter_mut().enumerate().filter(|&(i, _)| needed(i)) {
            *cell = discriminant(&side(0, i), &side(1, i));
        }
    }

    /// Adds up each side's weighted colours in every cell, and marks the cells with pixels near the contour.
    fn add_up(&mut self, patch: &Patch, distance: &[i16], colours: &Likelihoods, trust: Trust) {
        let mut room = [0.0; WEIGHTS];
        let weights = trust.weights(&mut room);
        for y in 0..patch.height {
            for x in 0..patch.width {
                let d = distance[y * patch.width + x];
                let Some(&weight) = weights.get(usize::from(d.unsigned_abs()) / 16) else { continue };
                let cell = y / CELL * self.columns + x / CELL;
                self.near[cell] |= d.unsigned_abs() < NEAR;
                let ratio = colours.ratio(patch.bytes(x, y));
                let foreign = if d > 0 { ratio < -FOREIGN } else { ratio > FOREIGN };
                let weight = if foreign { FOREIGN_WEIGHT * weight } else { weight };
                let [r, g, b] = patch.colour(x, y);
                let terms = [1.0, r, g, b, r * r, r * g, r * b, g * g, g * b, b * b];
                let sums = &mut self.sides[usize::from(d > 0)][cell];
                (0..SUMS).for_each(|s| sums[s] += weight * terms[s]);
            }
        }
    }

    /// The discriminant at a pixel, between those of the cells around it; precision 0 where nothing is known.
    pub fn at(&self, x: usize, y: usize) -> Discriminant {
        let place = |v: usize, n: usize| {
            let t = ((v as f32 + 0.5) / CELL as f32 - 0.5).clamp(0.0, (n - 1) as f32);
            let i = (t as usize).min(n - 1);
            (i, (i + 1).min(n - 1), t - i as f32)
        };
        let ((x0, x1, fx), (y0, y1, fy)) = (place(x, self.columns), place(y, self.rows));
        let corners = [
            (y0 * self.columns + x0, (1.0 - fx) * (1.0 - fy)),
            (y0 * self.columns + x1, fx * (1.0 - fy)),
            (y1 * self.columns + x0, (1.0 - fx) * fy),
            (y1 * self.columns + x1, fx * fy),
        ];
        let mut mean = Discriminant::default();
        let mut total = 0.0;
        for (i, weight) in corners {
            let cell = &self.cells[i];
            if cell.j > 0.0 {
                (0..3).for_each(|c| mean.direction[c] += weight * cell.direction[c]);
                mean.offset += weight * cell.offset;
                mean.j += weight * cell.j;
                total += weight;
            }
        }
        if total > 0.0 {
            let scale = 1.0 / total;
            mean.direction = mean.direction.map(|v| v * scale);
            mean.offset *= scale;
            mean.j *= scale;
        }
        mean
    }
}

/// Weighted sums over the cells around one. The first sum of a cell is 0 only if all are.
pub(super) fn gather<const N: usize>(
    sums: &[[f32; N]],
    columns: usize,
    rows: usize,
    i: usize,
    kernel: &[f32],
) -> [f32; N] {
    let (x, y, reach) = (i % columns, i / columns, kernel.len() / 2);
    let mut total = [0.0; N];
    for ny in y.saturating_sub(reach)..(y + reach + 1).min(rows) {
        for nx in x.saturating_sub(reach)..(x + reach + 1).min(columns) {
            let cell = &sums[ny * columns + nx];
            if cell[0] > 0.0 {
                let weight = kernel[nx + reach - x] * kernel[ny + reach - y];
                (0..N).for_each(|s| total[s] += weight * cell[s]);
            }
        }
    }
    total
}

/// Fisher's discriminant from the sums of background and object.
fn discriminant(background: &Sums, object: &Sums) -> Discriminant {
    if background[0] <= 1e-4 || object[0] <= 1e-4 {
        return Discriminant::default();
    }
    let mean = |s: &Sums| [s[1] / s[0], s[2] / s[0], s[3] / s[0]];
    let (b, f) = (mean(background), mean(object));
    // Pooled covariance: xx, xy, xz, yy, yz, zz.
    let mut v = [0.0f32; 6];
    for (sums, mean) in [(background, b), (object, f)] {
        let products = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        for (k, (i, j)) in products.into_iter().enumerate() {
            v[k] += 0.5 * (sums[4 + k] / sums[0] - mean[i] * mean[j]);
        }
    }
    let [xx, xy, xz, yy, yz, zz] =
        [v[0].max(0.0) + FLOOR, v[1], v[2], v[3].max(0.0) + FLOOR, v[4], v[5].max(0.0) + FLOOR];
    // Σ⁻¹ by its cofactors.
    let (cxx, cxy, cxz) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let (cyy, cyz, czz) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
    let determinant = xx * cxx + xy * cxy + xz * cxz;
    if !(determinant > 0.0) {
        return Discriminant::default();
    }
    let d = [f[0] - b[0], f[1] - b[1], f[2] - b[2]];
    let s = [
        (cxx * d[0] + cxy * d[1] + cxz * d[2]) / determinant,
        (cxy * d[0] + cyy * d[1] + cyz * d[2]) / determinant,
        (cxz * d[0] + cyz * d[1] + czz * d[2]) / determinant,
    ];
    let j = s[0] * d[0] + s[1] * d[1] + s[2] * d[2];
    if !(j > 1e-3) {
        return Discriminant::default();
    }
    let direction = s.map(|v| v / j);
    let offset = -(direction[0] * b[0] + direction[1] * b[1] + direction[2] * b[2]);
    Discriminant { direction, offset, j }
}
