//! §4.1: the depth map of one view, computed tile by tile.

use super::{
    level::PyramidLevel,
    range::SearchRange,
    sweep::{TILE, TILE_PIXELS, Tile},
    vote::{Curves, VoteParams, deviation},
};
use crate::{
    error::Result,
    simd::{Simd, Work},
};
use alloc::vec::Vec;
use glam::Vec3;

/// Parameters of the search (§4.1).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SearchParams {
    /// J: the number of neighbouring views that vote.
    pub neighbours: u32,
    /// Radius of the correlation window, in pixels of the resolution that is searched. At most 4.
    pub window_radius: u32,
    /// δ: spacing of the samples, as their average displacement in the neighbouring pictures, in pixels.
    pub step_pixels: f32,
    /// Orientation of the correlation windows.
    pub windows: Windows,
    /// How correlation curves determine the depth.
    pub vote: VoteParams,
    /// Whether to refine the position of the best sample by a parabola. The paper uses the sample itself.
    pub interpolate: bool,
}

impl SearchParams {
    /// Number of peaks with errors of their own in the support of a pixel: each view's, times the number of windows that
    /// fit in the area that the agreeing pixels' windows cover.
    fn independent_peaks(&self, views: usize) -> f32 {
        let side = (2 * self.window_radius + 1) as f32;
        let covered = side + (2 * self.vote.agreement_radius.unwrap_or(0)) as f32;
        views as f32 * (covered / side) * (covered / side)
    }
}

/// Orientation of the correlation windows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Windows {
    /// Parallel to the guide surface.
    Slanted,
    /// Parallel to the image plane, as in the paper.
    Upright,
}

/// Depth with its standard deviation, and fidelity f of eq. 1 per pixel, row after row.
#[derive(Debug, Clone, Default)]
pub struct DepthMap {
    /// Depth along the optical axis, in scene units. 0 where there is none.
    pub depth: Vec<f32>,
    /// Fidelity: the support of the neighbouring views. At most their number if peaks vote as printed; spread peaks can
    /// add up to more.
    pub fidelity: Vec<f32>,
    /// Standard deviation of the depth, in scene units. Means nothing where the depth was substituted.
    pub sigma: Vec<f32>,
    /// Number of neighbouring views that were compared.
    pub compared: Vec<u16>,
}

/// Largest number of depth hypotheses per tile. Tiles with a deeper range use larger steps.
const MAX_HYPOTHESES: usize = 256;

/// Finds the depth of every pixel. Each tile is compared with the first J of the `neighbours` whose pictures show it.
/// `keep_going` is called once per row of tiles, and its error cancels the search.
pub fn depth_map(
    target: &PyramidLevel,
    neighbours: &[&PyramidLevel],
    range: &SearchRange,
    params: &SearchParams,
    scratch: &mut SweepScratch,
    map: &mut DepthMap,
    mut keep_going: impl FnMut(usize, usize) -> Result<()>,
) -> Result<()> {
    let (w, h) = (target.camera.width as usize, target.camera.height as usize);
    for values in [&mut map.depth, &mut map.fidelity, &mut map.sigma] {
        values.clear();
        values.resize(w * h, 0.0);
    }
    map.compared.clear();
    map.compared.resize(w * h, 0);
    if neighbours.is_empty() {
        return Ok(());
    }
    let simd = Simd::detect();
    scratch.curves.tune(&params.vote);
    scratch.pairs.iter_mut().for_each(Vec::clear);
    scratch.pairs.resize_with(scratch.pairs.len().max(neighbours.len()), Vec::new);
    for y0 in (0..h).step_by(TILE) {
        keep_going(y0, h)?;
        let mut x0 = 0;
        // A tile starts at the first column with a pixel to search, so that a thin limb needs one tile and not two.
        while let Some(first) = (x0..w).find(|&x| (y0..(y0 + TILE).min(h)).any(|y| !range.of(y * w + x).is_empty())) {
            let (scratch, map) = (&mut *scratch, &mut *map);
            simd.run(TileSweep { target, neighbours, range, params, corner: (first, y0), scratch, map });
            x0 = first + TILE;
        }
    }
    Ok(())
}

/// Buffers that are reused for all tiles and views.
#[derive(Default)]
pub struct SweepScratch {
    tile: Tile,
    curves: Curves,
    flat: Vec<f32>,
    /// The neighbours' pairs of pixels ([`PyramidLevel::write_pairs`]). Empty for neighbours that have not been compared yet.
    pairs: Vec<Vec<u16>>,
}

/// The depth hypotheses of a tile. Hypothesis i has the inverse depth `1/guide - step * (i + first)`.
struct Hypotheses {
    first: f32,
    step: f32,
    count: usize,
}

impl Hypotheses {
    fn shift(&self, i: f32) -> f32 {
        self.step * (i + self.first)
    }

    /// Fractional index of the hypothesis at which a pixel has a given depth.
    fn position(&self, guide: f32, depth: f32) -> f32 {
        (1.0 / guide - 1.0 / depth) / self.step - self.first
    }
}

/// Finds the depths of one tile's pixels.
struct TileSweep<'a> {
    target: &'a PyramidLevel<'a>,
    neighbours: &'a [&'a PyramidLevel<'a>],
    range: &'a SearchRange,
    params: &'a SearchParams,
    corner: (usize, usize),
    scratch: &'a mut SweepScratch,
    map: &'a mut DepthMap,
}

impl Work for TileSweep<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        sweep_tile(self);
    }
}

#[inline(always)]
fn sweep_tile(tile: TileSweep) {
    let TileSweep { target, neighbours, range, params, corner: (x0, y0), scratch, map } = tile;
    let SweepScratch { tile, curves, flat, pairs } = scratch;
    let (w, h) = (target.camera.width as usize, target.camera.height as usize);
    let pixels = (y0..(y0 + TILE).min(h)).flat_map(move |y| (x0..(x0 + TILE).min(w)).map(move |x| (x, y)));
    let searched = pixels.filter(|&(x, y)| !range.of(y * w + x).is_empty());
    let guide: &[f32] = if params.windows == Windows::Slanted {
        &range.guide
    } else {
        // With one guide depth for the whole tile, its nearest, the hypotheses are planes.
        let nearest = searched.clone().map(|(x, y)| range.guide[y * w + x]).fold(f32::INFINITY, f32::min);
        flat.clear();
        flat.resize(w * h, nearest);
        flat
    };
    let Some(middle) = middle(target, guide, searched.clone()) else { return };
    let shown = neighbours.iter().copied().enumerate().filter(|(_, n)| n.camera.pixel(middle).is_some());
    let neighbours = shown.take(params.neighbours as usize);
    let compared = neighbours.clone().map(|(_, neighbour)| neighbour);
    let Some(hypotheses) = hypotheses(target, compared, middle, range, guide, params, searched.clone()) else {
        return;
    };
    tile.load(target, guide, x0, y0, params.window_radius as usize);
    curves.reset(hypotheses.count);
    let mut compared = 0u16;
    for (place, neighbour) in neighbours {
        compared += 1;
        let pairs = &mut pairs[place];
        if pairs.is_empty() {
            neighbour.write_pairs(pairs);
        }
        tile.face(target, neighbour, x0, y0);
        for (i, scores) in curves.scores_mut().iter_mut().enumerate() {
            tile.score(neighbour, pairs, hypotheses.shift(i as f32), scores);
        }
        curves.vote(&params.vote);
    }
    if let Some(radius) = params.vote.agreement_radius {
        let mut own = [false; TILE_PIXELS];
        for (x, y) in searched.clone() {
            own[(y - y0) * TILE + x - x0] = true;
        }
        curves.agree(radius as usize, &own);
    }
    let independent = params.independent_peaks(usize::from(compared));
    for (x, y) in searched {
        let pixel = y * w + x;
        let guide = guide[pixel];
        let mut best = (0.0, f32::NEG_INFINITY);
        for interval in range.of(pixel) {
            let last = hypotheses.count - 2;
            let first = (libm::ceilf(hypotheses.position(guide, interval.near)) as usize).clamp(1, last);
            let last = (libm::floorf(hypotheses.position(guide, interval.far)) as usize).clamp(first, last);
            let found = curves.best((y - y0) * TILE + x - x0, first, last, params.interpolate);
            if found.1 > best.1 {
                best = found;
            }
        }
        if best.1 > 0.0 {
            map.depth[pixel] = 1.0 / (1.0 / guide - hypotheses.shift(best.0));
            map.fidelity[pixel] = best.1;
            map.compared[pixel] = compared;
            // The derivative of the depth by the hypothesis is depth² step.
            let sigma = deviation(best.1 / f32::from(compared), independent, params.vote.support);
            map.sigma[pixel] = sigma * map.depth[pixel] * map.depth[pixel] * hypotheses.step;
        }
    }
}

/// The mean of the points on the guide surface that a tile's pixels see.
fn middle(target: &PyramidLevel, guide: &[f32], pixels: impl Iterator<Item = (usize, usize)>) -> Option<Vec3> {
    let w = target.camera.width as usize;
    let (mut sum, mut count) = (Vec3::ZERO, 0.0f32);
    for (x, y) in pixels {
        sum += target.camera.unproject(x as f32, y as f32, guide[y * w + x]);
        count += 1.0;
    }
    (count > 0.0).then(|| sum / count)
}

/// Chooses the hypotheses of a tile so that they cover the intervals of its pixels, with one more at either end. `middle`
/// is the middle of the tile.
fn hypotheses<'a>(
    target: &PyramidLevel,
    neighbours: impl Iterator<Item = &'a PyramidLevel<'a>>,
    middle: Vec3,
    range: &SearchRange,
    guide: &[f32],
    params: &SearchParams,
    pixels: impl Iterator<Item = (usize, usize)>,
) -> Option<Hypotheses> {
    let w = target.camera.width as usize;
    let (mut nearest, mut farthest) = (f32::INFINITY, f32::NEG_INFINITY);
    for (x, y) in pixels {
        let (guide, intervals) = (guide[y * w + x], range.of(y * w + x));
        nearest = nearest.min(1.0 / guide - 1.0 / intervals[0].near);
        farthest = farthest.max(1.0 / guide - 1.0 / intervals[intervals.len() - 1].far);
    }
    // Displacement in the neighbouring pictures per unit of inverse depth, at the middle of the tile, as the mean over
    // the neighbours.
    let ray = middle - target.camera.centre;
    let nudged = target.camera.centre + ray * (1.0 + 1e-3);
    let (mut displacement, mut count) = (0.0, 0.0f32);
    for n in neighbours {
        displacement += (n.camera.project(middle) - n.camera.project(nudged)).truncate().length();
        count += 1.0;
    }
    let speed = displacement * target.camera.depth(middle) / (1e-3 * count);
    if !(speed > 0.0) {
        return None;
    }
    let span = farthest - nearest;
    let step = (params.step_pixels / speed).max(span / (MAX_HYPOTHESES - 3) as f32);
    let count = libm::ceilf(span / step) as usize + 3;
    Some(Hypotheses { first: nearest / step - 1.0, step, count })
}
