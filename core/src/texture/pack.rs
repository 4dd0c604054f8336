//! Packs unfolded charts into a square texture: the largest first, each at the first place in reading order where it
//! covers no block of texels that another one covers.

use super::{cells::Cells, unfold::Unfolded};
use crate::error::Result;
use alloc::{vec, vec::Vec};
use glam::Vec2;

/// Charts are placed on a grid of blocks of this many texels.
const BLOCK: usize = 4;
/// Distance in texels that charts keep from each other, so that interpolation and the first mipmap mix no colours of
/// two charts. A block adds more on average.
const GUTTER: i32 = 2;
/// The part of the texture that charts are expected to fill.
const FILL: f32 = 0.75;
/// If the charts do not fit, they are made smaller by this factor.
const SHRINK: f32 = 0.965;
/// Below this part of the expected scale the gutters take more room than the charts.
const LEAST: f32 = 0.25;

/// Where the charts lie.
pub(super) struct Packed {
    /// Texels per unit of the scene.
    pub scale: f32,
    /// For each chart, the texel of its smallest coordinates.
    pub places: Vec<Vec2>,
}

/// Packs charts into a texture of `size` × `size` texels, as large as they fit. `None` if they are too many for it. `go_on` is
/// asked before every scale that is tried.
pub(super) fn pack(charts: &[Unfolded], size: u32, go_on: impl Fn() -> Result<()>) -> Result<Option<Packed>> {
    let area = charts.iter().flat_map(|chart| &chart.corners).map(|&c| area(c)).sum();
    let expected = expected_scale(area, size);
    let mut scale = expected;
    while scale > LEAST * expected {
        go_on()?;
        if let Some(places) = places(charts, size as usize, scale) {
            return Ok(Some(Packed { scale, places }));
        }
        scale *= SHRINK;
    }
    Ok(None)
}

/// The largest scale that can be expected to fit.
pub(super) fn expected_scale(area: f32, size: u32) -> f32 {
    size as f32 * libm::sqrtf(FILL / area.max(f32::MIN_POSITIVE))
}

/// Area of a triangle in the plane.
fn area([a, b, c]: [Vec2; 3]) -> f32 {
    ((b - a).perp_dot(c - a) * 0.5).abs()
}

/// The charts' places at a scale, or `None` if they do not fit.
fn places(charts: &[Unfolded], size: usize, scale: f32) -> Option<Vec<Vec2>> {
    let shapes: Vec<Shape> = charts.iter().map(|chart| Shape::new(chart, scale)).collect();
    let mut order: Vec<usize> = (0..charts.len()).collect();
    // Ties are broken by the index.
    order.sort_by_key(|&i| (core::cmp::Reverse(shapes[i].height * shapes[i].width), i));
    let mut atlas = Atlas::new(size / BLOCK);
    let mut places = vec![Vec2::ZERO; charts.len()];
    for i in order {
        let [x, y] = atlas.place(&shapes[i])?;
        places[i] = Vec2::new((x * BLOCK) as f32, (y * BLOCK) as f32) + shapes[i].offset;
    }
    Some(places)
}

/// The blocks that a chart covers with its gutter.
struct Shape {
    width: usize,
    height: usize,
    /// Words of 64 blocks per row.
    words: usize,
    rows: Vec<u64>,
    /// Position of the chart's smallest coordinates in the shape, in texels.
    offset: Vec2,
}

impl Shape {
    fn new(chart: &Unfolded, scale: f32) -> Self {
        let offset = Vec2::splat(GUTTER as f32);
        // A gutter on both sides, and one texel for rounding.
        let blocks = |v: f32| ((v * scale) as usize + 2 * GUTTER as usize + 1) / BLOCK + 1;
        let (width, height) = (blocks(chart.size.x), blocks(chart.size.y));
        let words = width.div_ceil(64);
        let mut shape = Self { width, height, words, rows: vec![0; words * height], offset };
        for corners in &chart.corners {
            let corners = corners.map(|p| p * scale + offset);
            // Also the corners, which may cover no centre of a texel.
            corners.iter().for_each(|p| shape.cover(libm::roundf(p.x) as i32, libm::roundf(p.y) as i32));
            if let Some(cells) = Cells::new(corners) {
                cells.for_each(|cell| shape.cover(cell.x, cell.y));
            }
        }
        shape
    }

    /// Covers the blocks around a texel.
    fn cover(&mut self, x: i32, y: i32) {
        for y in [y - GUTTER, y + GUTTER] {
            for x in [x - GUTTER, x + GUTTER] {
                let block = |v: i32, most: usize| (v.max(0) as usize / BLOCK).min(most - 1);
                let (x, y) = (block(x, self.width), block(y, self.height));
                self.rows[y * self.words + x / 64] |= 1 << (x % 64);
            }
        }
    }
}

/// The blocks of the texture that are covered.
struct Atlas {
    size: usize,
    words: usize,
    rows: Vec<u64>,
}

impl Atlas {
    fn new(size: usize) -> Self {
        let words = size.div_ceil(64) + 1;
        Self { size, words, rows: vec![0; words * size] }
    }

    /// Places a shape and returns its first block.
    fn place(&mut self, shape: &Shape) -> Option<[usize; 2]> {
        if shape.width > self.size || shape.height > self.size {
            return None;
        }
        for y in 0..=self.size - shape.height {
            let mut x = 0;
            while x <= self.size - shape.width {
                if self.is_free(shape, x, y) {
                    self.cover(shape, x, y);
                    return Some([x, y]);
                }
                x += 1;
            }
        }
        None
    }

    fn is_free(&self, shape: &Shape, x: usize, y: usize) -> bool {
        (0..shape.height).all(|row| {
            let ours = &self.rows[(y + row) * self.words..][..self.words];
            let theirs = &shape.rows[row * shape.words..][..shape.words];
            theirs.iter().enumerate().all(|(k, &word)| {
                let (low, high) = shifted(word, x % 64);
                let at = x / 64 + k;
                ours[at] & low == 0 && (high == 0 || ours[at + 1] & high == 0)
            })
        })
    }

    fn cover(&mut self, shape: &Shape, x: usize, y: usize) {
        for row in 0..shape.height {
            for k in 0..shape.words {
                let (low, high) = shifted(shape.rows[row * shape.words + k], x % 64);
                let at = (y + row) * self.words + x / 64 + k;
                self.rows[at] |= low;
                if high != 0 {
                    self.rows[at + 1] |= high;
                }
            }
        }
    }
}

/// A word moved up by `by` bits, over two words.
fn shifted(word: u64, by: usize) -> (u64, u64) {
    (word << by, if by == 0 { 0 } else { word >> (64 - by) })
}
