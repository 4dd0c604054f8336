//! One level of the hierarchy of grids. The spacing of the nodes halves from each level to the next finer one.

use alloc::{vec, vec::Vec};

use super::samples::{Sample, mark};
use crate::executor::Executor;
use crate::grid::{BLOCK, BLOCK_NODES, BLOCKS_PER_JOB, SparseGrid};
use crate::surface::neighbourhood::Neighbourhood;
use crate::workspace::Workspace;

/// A level's grid and the indicator function χ on it: 1 inside the object, 0 outside.
pub(super) struct GridLevel {
    pub(super) grid: SparseGrid,
    pub(super) chi: Vec<f32>,
}

/// Distance around the points, in voxels, within which nodes are stored. On coarse levels it covers what the next finer
/// level needs.
const REACH: f32 = 2.0;
const REACH_COARSE: f32 = 5.0;

/// χ at a node of the last level, interpolated from a coarser level where the last one stores nothing.
fn value(levels: &[GridLevel], [x, y, z]: [i32; 3]) -> f32 {
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

impl GridLevel {
    /// The coarsest level, which stores the whole domain.
    pub(super) fn coarsest(finest: &SparseGrid, level: usize, workspace: &mut Workspace) -> Self {
        let dims = finest.dims.map(|v| v >> level);
        let grid = SparseGrid::new(finest.origin, finest.voxel * (1 << level) as f32, dims, |_| 0);
        let chi = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
        Self { grid, chi }
    }

    /// The next finer level: stores the blocks that the points reach and those that the surface χ = `iso` can pass. χ
    /// is interpolated from the coarser levels.
    pub(super) fn refine(
        levels: &[GridLevel],
        samples: &[Sample],
        level: usize,
        iso: f32,
        workspace: &mut Workspace,
        executor: &dyn Executor,
    ) -> Self {
        let coarse = &levels[levels.len() - 1];
        let dims = coarse.grid.dims.map(|v| 2 * v);
        let reach = if level == 0 { REACH } else { REACH_COARSE };
        let marks = mark(samples, dims, level, reach, executor);
        let states = states(coarse, iso, executor);
        let grid = SparseGrid::new(coarse.grid.origin, coarse.grid.voxel * 0.5, dims, |[x, y, z]| {
            let index = ((z * dims[1] + y) * dims[0] + x) as usize;
            if marks[index] { 0 } else { states[index] }
        });
        let mut chi = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
        prolong(|node| value(levels, node), &grid, 1.0, &mut chi, executor);
        Self { grid, chi }
    }
}

/// For each block of the next finer level: inside, outside, or 0 if there are nodes on both sides of `iso` in it or
/// next to it.
fn states(coarse: &GridLevel, iso: f32, executor: &dyn Executor) -> Vec<u32> {
    let grid = &coarse.grid;
    let [w, h, d] = grid.dims.map(|v| 2 * v as usize);
    let mut states = vec![SparseGrid::OUTSIDE; w * h * d];
    let parts: Vec<&[[u16; 3]]> = grid.blocks.chunks(BLOCKS_PER_JOB).collect();
    let children: Vec<Vec<[u32; 8]>> = executor.map(parts.len(), |part| {
        let mut around = Neighbourhood::new();
        let states = |block: &[u16; 3]| {
            around.load(grid, &coarse.chi, block.map(i32::from), 1.0, 0.0);
            core::array::from_fn(|child| state(&around, child, iso))
        };
        parts[part].iter().map(states).collect()
    });
    for block in (0..(w * h * d / 8) as i32).map(|i| {
        let (w, h) = (w as i32 / 2, h as i32 / 2);
        [i % w, i / w % h, i / w / h]
    }) {
        let slot = grid.slot(block[0], block[1], block[2]);
        for child in 0..8 {
            let [x, y, z] = core::array::from_fn(|k| 2 * block[k] as usize + (child >> k & 1));
            let stored = slot < SparseGrid::INSIDE;
            states[(z * h + y) * w + x] = if stored {
                children[slot as usize / BLOCKS_PER_JOB][slot as usize % BLOCKS_PER_JOB][child]
            } else {
                slot
            };
        }
    }
    states
}

/// State of one of the eight children of a coarse block, from its coarse nodes and those next to it.
fn state(around: &Neighbourhood, child: usize, iso: f32) -> u32 {
    const HALF: i32 = BLOCK as i32 / 2;
    let [x, y, z] = core::array::from_fn(|k| (child >> k & 1) as i32 * HALF - 1);
    let first = around.0[Neighbourhood::index(x, y, z)] > iso;
    for z in z..=z + HALF + 2 {
        for y in y..=y + HALF + 2 {
            let row = Neighbourhood::index(x, y, z);
            if around.0[row..=row + BLOCK / 2 + 2].iter().any(|&value| (value > iso) != first) {
                return 0;
            }
        }
    }
    if first { SparseGrid::INSIDE } else { SparseGrid::OUTSIDE }
}

/// Interpolates a coarse field trilinearly and adds it, times `scale`, to a field on the next finer grid. `coarse`
/// returns the values at the coarse nodes.
pub(super) fn prolong(
    coarse: impl Fn([i32; 3]) -> f32 + Sync,
    grid: &SparseGrid,
    scale: f32,
    fine: &mut [f32],
    executor: &dyn Executor,
) {
    const COARSE: usize = BLOCK / 2 + 1;
    let interpolate = |block: &[u16; 3], out: &mut [f32]| {
        let mut nodes = [0.0; COARSE * COARSE * COARSE];
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
    };
    grid.for_each_part(fine, executor, |blocks| blocks.for_each(|(block, out)| interpolate(block, out)));
}
