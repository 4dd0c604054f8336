//! The colour of an unevenly lit backdrop.

use crate::silhouette::colour::{vector, within};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Edge length in pixels of the tiles in which the backdrop's colour is estimated.
const TILE: usize = 32;
/// Number of backdrop pixels from which a tile relies on its own estimate alone.
const TILE_PIXELS: f32 = 64.0;
/// Number of iterations that spread the colour to tiles with too little backdrop.
const SPREAD: usize = 64;

/// The backdrop's colour over the picture: one estimate per tile, interpolated bilinearly between the tiles' centres.
pub(super) struct Backdrop {
    columns: usize,
    rows: usize,
    tiles: Vec<Vec3>,
}

impl Backdrop {
    /// Estimates the colour from the pixels whose angle to `global` is at most `limit`.
    pub fn estimate(width: usize, height: usize, rgb: &[u8], global: Vec3, limit: f32) -> Self {
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

    /// The colour at a pixel.
    pub fn at(&self, x: usize, y: usize) -> Vec3 {
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
