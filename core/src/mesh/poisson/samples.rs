//! The points as samples of the surface: how much of it each one stands for, and at which level of detail.

use alloc::{vec, vec::Vec};
use glam::Vec3;

use super::spline::{ABSENT, Stencil};
use crate::error::Result;
use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};
use crate::math::{max, min, sqrt};
use crate::point_cloud::Point;
use crate::workspace::Workspace;

/// Edge of the cells in which points are merged, in voxels.
const MERGED: f32 = 0.5;

/// The points of a small cell that take part, in coordinates of the finest grid (nodes at integers).
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) at: Vec3,
    /// Mean of the unit normals, outward; shorter than 1 where they differ.
    pub(super) normal: Vec3,
    /// How many points.
    count: f32,
    /// Weight (eq. 3), later also share of the surface: see [`weigh`].
    pub(super) area: f32,
    /// Level at which points are about one voxel apart, 0 the finest; between two levels the point acts on both.
    pub(super) detail: f32,
    /// Its cell, in an order in which eight neighbouring cells' keys differ in the last three bits only.
    cell: u64,
}

/// The points with a normal and a positive weight, merged cell by cell, in an order that does not depend on the order
/// of `points`. `step` is called between its parts.
pub(super) fn collect(
    points: &[Point],
    grid: &SparseGrid,
    workspace: &mut Workspace,
    mut step: impl FnMut() -> Result<()>,
) -> Result<Vec<Sample>> {
    let mut keyed: Vec<(u64, u32)> = workspace.empty(points.len());
    let size = grid.dims.map(|v| (v as usize * BLOCK) as f32);
    for (i, point) in points.iter().enumerate() {
        let at = (point.position - grid.origin) / grid.voxel;
        let usable = point.weight > 0.0 && point.weight.is_finite() && at.is_finite() && point.normal.length() > 0.5;
        if usable && (0..3).all(|k| at[k] >= 2.0 && at[k] < size[k] - 3.0) {
            let [x, y, z] = (at / MERGED).to_array().map(|v| v as u64);
            keyed.push((spread(x) | spread(y) << 1 | spread(z) << 2, i as u32));
        }
    }
    step()?;
    keyed.sort_unstable();
    step()?;
    let bits = |&(_, i): &(u64, u32)| {
        let p = &points[i as usize];
        (p.position.to_array().map(f32::to_bits), p.normal.to_array().map(f32::to_bits), p.weight.to_bits())
    };
    let mut samples = workspace.empty(keyed.len() / 2);
    for cell in keyed.chunk_by_mut(|a, b| a.0 == b.0) {
        cell.sort_unstable_by_key(bits);
        samples.push(merged(cell, points, grid));
    }
    workspace.recycle(keyed);
    step()?;
    Ok(samples)
}

/// Moves the lowest 21 bits three places apart (Morton order).
fn spread(v: u64) -> u64 {
    let v = (v | v << 32) & 0x001f_0000_0000_ffff;
    let v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    let v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    let v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// Means by weight of a cell's points: the field of their normals stays the same but for its finest detail.
fn merged(cell: &[(u64, u32)], points: &[Point], grid: &SparseGrid) -> Sample {
    let (mut at, mut normal, mut area) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for &(_, i) in cell {
        let point = &points[i as usize];
        at += (point.position - grid.origin) / grid.voxel * point.weight;
        normal += point.normal * (point.weight / point.normal.length());
        area += point.weight;
    }
    let count = cell.len() as f32;
    Sample { at: at / area, normal: normal / area, count, area, detail: 0.0, cell: cell[0].0 }
}

/// Samples for a level from those for the next finer one: in cells of twice the size, those that are `settled` merged.
pub(super) fn coarser(samples: &[Sample], settled: impl Fn(&Sample) -> bool, workspace: &mut Workspace) -> Vec<Sample> {
    let mut merged: Vec<Sample> = workspace.empty(samples.len() / 2);
    for family in samples.chunk_by(|a, b| a.cell >> 3 == b.cell >> 3) {
        let cell = family[0].cell >> 3;
        let empty = Sample { at: Vec3::ZERO, normal: Vec3::ZERO, count: 0.0, area: 0.0, detail: 0.0, cell };
        let (mut sum, first) = (empty, merged.len());
        for sample in family {
            if settled(sample) {
                sum.at += sample.at * sample.area;
                sum.normal += sample.normal * sample.area;
                sum.count += sample.count;
                sum.area += sample.area;
                sum.detail = max(sum.detail, sample.detail);
            } else {
                merged.push(Sample { cell, ..*sample });
            }
        }
        if sum.area > 0.0 {
            merged.insert(first, Sample { at: sum.at / sum.area, normal: sum.normal / sum.area, ..sum });
        }
    }
    merged
}

/// What the autocorrelation of the quadratic B-spline sums to over a plane with one point a square voxel.
const PLANE: f32 = 0.556;

/// Fewest points a square voxel for which a density counts as measured at a level.
const DENSE: f32 = 1.0;

/// Samples whose density is looked up between two steps of progress.
const SAMPLES_A_STEP: usize = 1 << 18;

/// Width of a sample's spline in spacings of the samples around it.
const SPREAD: f32 = 1.5;

/// Sets each sample's share of the surface, in square voxels, and its level of detail from the density of the samples
/// around it. Dense and sparse parts of the cloud then bound the same volume, and weights (eq. 3) decide between
/// neighbours only.
/// `step` is called at least four times a level.
pub(super) fn weigh(
    samples: &mut [Sample],
    finest: &SparseGrid,
    levels: usize,
    workspace: &mut Workspace,
    mut step: impl FnMut() -> Result<()>,
) -> Result<()> {
    let mut waiting: Vec<u32> = workspace.empty(samples.len());
    waiting.extend(0..samples.len() as u32);
    let mut shares: Vec<(f32, f32)> = workspace.filled((0.0, 0.0), samples.len());
    let mut merged = Vec::new();
    for level in 1..levels {
        let next = coarser(if level == 1 { samples } else { &merged }, |_| true, workspace);
        workspace.recycle(core::mem::replace(&mut merged, next));
        let scale = 1.0 / (1 << level) as f32;
        let grid = around(&merged, finest, level, 2.0);
        step()?;
        let density = density(&merged, &grid, scale, workspace);
        step()?;
        let last = level == levels - 1;
        // Those left over move to the front.
        let mut left = 0;
        for n in 0..waiting.len() {
            if n % SAMPLES_A_STEP == 0 {
                step()?;
            }
            let i = waiting[n];
            let sample = &samples[i as usize];
            let [count, weight] = Stencil::new(&grid, sample.at * scale).gather(&density);
            let count = count / PLANE;
            if count >= DENSE || last {
                // From one level's square voxels to the finest's.
                let area = PLANE * sample.area / weight / (scale * scale);
                let spacing = 1.0 / (scale * sqrt(count));
                let detail = libm::log2f(SPREAD * spacing).clamp(0.0, (levels - 1) as f32);
                shares[i as usize] = (area, detail);
            } else {
                waiting[left] = i;
                left += 1;
            }
        }
        waiting.truncate(left);
        workspace.recycle(density);
        step()?;
        if waiting.is_empty() {
            break;
        }
    }
    for (sample, &(area, detail)) in samples.iter_mut().zip(&shares) {
        sample.area = area;
        sample.detail = detail;
    }
    workspace.recycle(waiting);
    workspace.recycle(shares);
    workspace.recycle(merged);
    Ok(())
}

/// Number of samples and sum of their areas per cubic voxel, smoothed by the B-spline.
fn density(samples: &[Sample], grid: &SparseGrid, scale: f32, workspace: &mut Workspace) -> Vec<[f32; 2]> {
    let mut density = workspace.filled([0.0; 2], grid.blocks.len() * BLOCK_NODES);
    for sample in samples {
        let stencil = Stencil::new(grid, sample.at * scale);
        let [vx, vy, vz] = &stencil.values;
        for (i, &node) in stencil.nodes.iter().enumerate() {
            if node != ABSENT {
                let value = vx[i % 3] * vy[i / 3 % 3] * vz[i / 9];
                density[node as usize][0] += value * sample.count;
                density[node as usize][1] += value * sample.area;
            }
        }
    }
    density
}

/// Blocks of a level's grid that hold a node within `reach` voxels of a sample.
pub(super) fn mark(samples: &[Sample], dims: [u32; 3], level: usize, reach: f32) -> Vec<bool> {
    let mut marks = vec![false; (dims[0] * dims[1] * dims[2]) as usize];
    let scale = 1.0 / (1 << level) as f32;
    for sample in samples {
        let at = sample.at * scale;
        let block = |v: f32, k: usize| min(max(v, 0.0) / BLOCK as f32, (dims[k] - 1) as f32) as u32;
        let low: [u32; 3] = core::array::from_fn(|k| block(at[k] - reach, k));
        let high: [u32; 3] = core::array::from_fn(|k| block(at[k] + reach, k));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    marks[((z * dims[1] + y) * dims[0] + x) as usize] = true;
                }
            }
        }
    }
    marks
}

/// A level's grid of the blocks around the samples.
fn around(samples: &[Sample], finest: &SparseGrid, level: usize, reach: f32) -> SparseGrid {
    let dims = finest.dims.map(|v| v >> level);
    let marks = mark(samples, dims, level, reach);
    let voxel = finest.voxel * (1 << level) as f32;
    SparseGrid::new(finest.origin, voxel, dims, |[x, y, z]| {
        if marks[((z * dims[1] + y) * dims[0] + x) as usize] { 0 } else { SparseGrid::OUTSIDE }
    })
}
