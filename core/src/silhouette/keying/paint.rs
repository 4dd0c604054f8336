//! A painted backdrop: one colour, unevenly lit.

use super::likeness::Likeness;
use crate::silhouette::colour::vector;
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Edge length in pixels of the tiles in which the backdrop's colour is estimated.
const TILE: usize = 32;
/// Number of backdrop pixels from which a tile relies on its own estimate alone.
const TILE_PIXELS: f32 = 64.0;
/// Number of iterations that spread the colour to tiles with too little backdrop.
const SPREAD: usize = 64;
/// Pixels nearer to the initial colour than this share of its distance from grey are the first estimate.
const INITIAL: f32 = 0.6;
/// A pixel is paint if it differs from the paint nearby by at most this many times what this quantile of the paint does. The
/// quantile is that of one standard deviation, in two dimensions about the median.
const PAINT_TIMES: f32 = 3.0;
const PAINT_QUANTILE: f32 = 0.7;
/// Smallest limit of paint, as a share of the tolerated angle.
const PAINT_LEAST: f32 = 0.2;
/// Steps of the tolerated angle in which deviations are counted.
const STEPS: usize = 256;

/// A backdrop's local colours, and how much colours may differ from them.
pub(in crate::silhouette) struct Paint {
    backdrop: Backdrop,
    /// Cosine of the tolerated angle.
    cosine: f32,
    /// Angle in radians within which pixels certainly are paint.
    certain: f32,
    darkest_shadow: f32,
}

impl Paint {
    /// Finds the paint in a picture of packed sRGB. `hint` is its approximate colour; `tolerance` the tolerated angle as a
    /// share of the angle between the paint and grey. `None` if no pixel is close to the hint.
    pub fn find(w: usize, h: usize, rgb: &[u8], hint: Vec3, tolerance: f32, darkest_shadow: f32) -> Option<Self> {
        let global = mean(rgb, hint, from_gray(hint) * INITIAL)?;
        let limit = from_gray(global) * tolerance;
        let backdrop = Backdrop::estimate(w, h, rgb, global, limit);
        let mut paint = Self { backdrop, certain: limit, cosine: libm::cosf(limit), darkest_shadow };
        let mut counts = [0u32; STEPS];
        for i in 0..w * h {
            if let Some(deviation) = paint.deviation(w, rgb, i) {
                counts[((deviation / limit * STEPS as f32) as usize).min(STEPS - 1)] += 1;
            }
        }
        let wanted = (PAINT_QUANTILE * counts.iter().sum::<u32>() as f32) as u32;
        let mut below = 0;
        let quantile = counts.iter().position(|count| {
            below += count;
            below >= wanted
        });
        let share = (quantile.unwrap_or(STEPS) + 1) as f32 / STEPS as f32;
        paint.certain = limit * (PAINT_TIMES * share).clamp(PAINT_LEAST, 1.0);
        Some(paint)
    }

    /// How a pixel compares with the paint.
    pub fn likeness(&self, w: usize, rgb: &[u8], i: usize) -> Likeness {
        match self.deviation(w, rgb, i) {
            None => Likeness::Other,
            Some(deviation) if deviation <= self.certain => Likeness::Paint,
            Some(_) => Likeness::Similar,
        }
    }

    /// Angle between a pixel's colour and the local paint's, if it is tolerated and the pixel is not darker than a shadow.
    fn deviation(&self, w: usize, rgb: &[u8], i: usize) -> Option<f32> {
        let (colour, local) = (vector(&rgb[3 * i..]), self.backdrop.at(i % w, i / w));
        let (along, brightness) = (colour.dot(local), local.length_squared());
        if along < self.darkest_shadow * brightness || !within(colour, local, self.cosine) {
            return None;
        }
        Some(angle(colour, local))
    }
}

/// Angle between a colour and grey in radians.
pub(in crate::silhouette) fn from_gray(colour: Vec3) -> f32 {
    angle(colour, Vec3::ONE)
}

/// Angle between two colour vectors in radians.
fn angle(a: Vec3, b: Vec3) -> f32 {
    let lengths = libm::sqrtf(a.length_squared() * b.length_squared());
    if lengths > 0.0 { libm::acosf((a.dot(b) / lengths).clamp(-1.0, 1.0)) } else { 0.0 }
}

fn within(colour: Vec3, centre: Vec3, cosine: f32) -> bool {
    let along = colour.dot(centre);
    along > 0.0 && along * along >= cosine * cosine * colour.length_squared() * centre.length_squared()
}

/// Mean of the colours whose angle to a centre is less than `limit` radians.
fn mean(rgb: &[u8], centre: Vec3, limit: f32) -> Option<Vec3> {
    let cosine = libm::cosf(limit);
    let (mut sums, mut count) = ([0u64; 3], 0u64);
    for pixel in rgb.chunks_exact(3).filter(|p| within(vector(p), centre, cosine)) {
        (0..3).for_each(|c| sums[c] += u64::from(pixel[c]));
        count += 1;
    }
    (count > 0).then(|| Vec3::from_array(sums.map(|s| s as f32 / count as f32)))
}

/// The backdrop's colour over the picture: one estimate per tile, interpolated bilinearly between the tiles' centres.
struct Backdrop {
    columns: usize,
    rows: usize,
    tiles: Vec<Vec3>,
}

impl Backdrop {
    fn estimate(width: usize, height: usize, rgb: &[u8], global: Vec3, limit: f32) -> Self {
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let cosine = libm::cosf(limit);
        let mut sums = vec![(Vec3::ZERO, 0.0f32); columns * rows];
        for (i, pixel) in rgb.chunks_exact(3).enumerate() {
            let colour = vector(pixel);
            if within(colour, global, cosine) {
                let tile = &mut sums[i / width / TILE * columns + i % width / TILE];
                *tile = (tile.0 + colour, tile.1 + 1.0);
            }
        }
        // Tiles with few backdrop pixels take their colour partly or fully from the neighbouring tiles.
        let own = |&(sum, count): &(Vec3, f32)| if count > 0.0 { sum / count } else { global };
        let mut tiles: Vec<Vec3> = sums.iter().map(own).collect();
        for _ in 0..SPREAD {
            for y in 0..rows {
                for x in 0..columns {
                    let i = y * columns + x;
                    let trust = (sums[i].1 / TILE_PIXELS).min(1.0);
                    let around = [
                        tiles[i - usize::from(x > 0)],
                        tiles[i + usize::from(x + 1 < columns)],
                        tiles[i - columns * usize::from(y > 0)],
                        tiles[i + columns * usize::from(y + 1 < rows)],
                    ];
                    let neighbours = (around[0] + around[1] + around[2] + around[3]) * 0.25;
                    tiles[i] = own(&sums[i]) * trust + neighbours * (1.0 - trust);
                }
            }
        }
        Self { columns, rows, tiles }
    }

    fn at(&self, x: usize, y: usize) -> Vec3 {
        let place = |v: usize, n: usize| {
            let t = ((v as f32 + 0.5) / TILE as f32 - 0.5).clamp(0.0, (n - 1) as f32);
            let i = (t as usize).min(n.saturating_sub(2));
            (i, (i + 1).min(n - 1), t - i as f32)
        };
        let ((x0, x1, fx), (y0, y1, fy)) = (place(x, self.columns), place(y, self.rows));
        let row = |y: usize| self.tiles[y * self.columns + x0].lerp(self.tiles[y * self.columns + x1], fx);
        row(y0).lerp(row(y1), fy)
    }
}
