//! One level of the hierarchy of grids, coarse to fine, each with nodes half as far apart.

use alloc::{vec, vec::Vec};

use super::samples::{Sample, mark};
use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};

/// A level's grid and the indicator function χ on it: 1 inside the object, 0 outside.
pub(super) struct Level {
    pub(super) grid: SparseGrid,
    pub(super) chi: Vec<f32>,
}

/// How far around the points, in voxels, nodes are stored. On a coarse level this covers what the finer one needs.
const REACH: f32 = 2.0;
const REACH_COARSE: f32 = 5.0;

/// χ at a node of the last of the levels, from a coarser one where the last stores nothing.
fn value(levels: &[Level], [x, y, z]: [i32; 3]) -> f32 {
    let Some((level, coarser)) = levels.split_last() else { return 0.0 };
    let (slot, local) = level.grid.locate(x, y, z);
    if slot < SparseGrid::INSIDE {
        return level.chi[slot as usize * BLOCK_NODES + local];
    }
    let mut sum = 0.0;
    for corner in 0..8 {
        let at = |v: i32, k: i32| (v + (corner >> k & 1)) >> 1;
        sum += value(coarser, [at(x, 0), at(y, 1), at(z, 2)]);
    }
    sum * 0.125
}

impl Level {
    /// The coarsest level: all of the domain.
    pub(super) fn coarsest(finest: &SparseGrid, level: usize) -> Self {
        let dims = finest.dims.map(|v| v >> level);
        let grid = SparseGrid::new(finest.origin, finest.voxel * (1 << level) as f32, dims, |_| 0);
        let chi = vec![0.0; grid.blocks.len() * BLOCK_NODES];
        Self { grid, chi }
    }

    /// The next finer level: the blocks that points reach or that χ = `iso` can pass, with χ interpolated.
    pub(super) fn refine(levels: &[Level], samples: &[Sample], level: usize, iso: f32) -> Self {
        let coarse = &levels[levels.len() - 1];
        let dims = coarse.grid.dims.map(|v| 2 * v);
        let reach = if level == 0 { REACH } else { REACH_COARSE };
        let marks = mark(samples, dims, level, reach);
        let states = states(coarse, iso);
        let grid = SparseGrid::new(coarse.grid.origin, coarse.grid.voxel * 0.5, dims, |[x, y, z]| {
            let index = ((z * dims[1] + y) * dims[0] + x) as usize;
            if marks[index] { 0 } else { states[index] }
        });
        let mut chi = vec![0.0; grid.blocks.len() * BLOCK_NODES];
        prolong(|node| value(levels, node), &grid, 1.0, &mut chi);
        Self { grid, chi }
    }
}

/// For each block of the next finer level: inside, outside, or (0) with nodes on both sides of `iso` in it or near it.
fn states(coarse: &Level, iso: f32) -> Vec<u32> {
    let [w, h, d] = coarse.grid.dims;
    let half = BLOCK as i32 / 2;
    let mut states = Vec::with_capacity((8 * w * h * d) as usize);
    for z in 0..2 * d as i32 {
        for y in 0..2 * h as i32 {
            for x in 0..2 * w as i32 {
                let slot = coarse.grid.slot(x >> 1, y >> 1, z >> 1);
                if slot >= SparseGrid::INSIDE {
                    states.push(slot);
                    continue;
                }
                let inside = |x, y, z| coarse.grid.value(&coarse.chi, x, y, z, 0.0, 1.0) > iso;
                let first = inside(x * half, y * half, z * half);
                let span = |v: i32| v * half - 1..=v * half + half + 1;
                let same = span(z).all(|z| span(y).all(|y| span(x).all(|x| inside(x, y, z) == first)));
                states.push(match (same, first) {
                    (false, _) => 0,
                    (true, true) => SparseGrid::INSIDE,
                    (true, false) => SparseGrid::OUTSIDE,
                });
            }
        }
    }
    states
}

/// Adds a coarse field, times `scale`, to one of the next finer grid by trilinear interpolation. `coarse` gives the
/// values of the coarse grid's nodes.
pub(super) fn prolong(coarse: impl Fn([i32; 3]) -> f32, grid: &SparseGrid, scale: f32, fine: &mut [f32]) {
    const COARSE: usize = BLOCK / 2 + 1;
    let mut nodes = [0.0; COARSE * COARSE * COARSE];
    for (block, out) in grid.blocks.iter().zip(fine.chunks_exact_mut(BLOCK_NODES)) {
        let first = block.map(|v| i32::from(v) * (BLOCK / 2) as i32);
        for (i, node) in nodes.iter_mut().enumerate() {
            let offset = [i % COARSE, i / COARSE % COARSE, i / COARSE / COARSE];
            *node = coarse(core::array::from_fn(|k| first[k] + offset[k] as i32));
        }
        for (i, out) in out.iter_mut().enumerate() {
            let at = [i % BLOCK, i / BLOCK % BLOCK, i / BLOCK / BLOCK];
            let (low, high) = (at.map(|v| v / 2), at.map(|v| v.div_ceil(2)));
            let mean = |y: usize, z: usize| {
                let row = (z * COARSE + y) * COARSE;
                nodes[row + low[0]] + nodes[row + high[0]]
            };
            let sum = mean(low[1], low[2]) + mean(high[1], low[2]) + mean(low[1], high[2]) + mean(high[1], high[2]);
            *out += scale * 0.125 * sum;
        }
    }
}
