//! The points as samples of the surface: the area that each one represents, and its level of detail.

use alloc::{borrow::Cow, vec, vec::Vec};
use glam::Vec3;

use super::patch::{self, Patch, SAMPLES_PER_STEP};
use super::spline::Stencil;
use crate::error::Result;
use crate::executor::Executor;
use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};
use crate::math::{max, min, sqrt};
use crate::point_cloud::Point;
use crate::sort;
use crate::workspace::Workspace;

/// Points that one job of an executor works on.
const POINTS_PER_JOB: usize = 1 << 14;
/// Bits of a coordinate by which points are distributed to jobs.
const BUCKET_BITS: u32 = 4;

/// Edge length of the cells in which points are merged, in voxels.
const MERGED: f32 = 0.5;

/// The merged points of a small cell, in coordinates of the finest grid (nodes at integers).
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) at: Vec3,
    /// Mean of the outward unit normals. Shorter than 1 if they differ.
    pub(super) normal: Vec3,
    /// Weighted mean of the points' standard deviations.
    pub(super) sigma: f32,
    /// Number of points.
    count: f32,
    /// Sum of the weights (eq. 3). [`weigh`] replaces it by the area of the surface that the sample represents.
    pub(super) area: f32,
    /// Level at which the points are about one voxel apart; 0 is the finest. A sample between two levels acts on both.
    pub(super) detail: f32,
    /// Morton code of the cell: the codes of the eight cells with the same parent differ only in the last three bits.
    cell: u64,
}

/// Merges the points with a normal and a positive weight cell by cell. The result does not depend on the order of
/// `points`, which are freed if they are owned. `step` is called between the phases.
pub(super) fn collect(
    points: Cow<[Point]>,
    grid: &SparseGrid,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    mut step: impl FnMut() -> Result<()>,
) -> Result<Vec<Sample>> {
    let parts: Vec<&[Point]> = points.chunks(POINTS_PER_JOB).collect();
    let found = executor.map(parts.len(), |i| keyed(parts[i], (i * POINTS_PER_JOB) as u32, grid));
    step()?;
    let (mut keyed, ends) = distributed(&found, grid, workspace);
    drop(found);
    step()?;
    let mut rest = &mut keyed[..];
    let mut start = 0;
    let parts = ends.iter().map(|&end| {
        let (part, others) = core::mem::take(&mut rest).split_at_mut(end - start);
        (rest, start) = (others, end);
        part
    });
    let merged = executor.map_parts(parts, |_, part| merged_cells(part, &points, grid));
    // Keys and points are freed before the samples are put together, and then one part after the other, because this is where
    // a frame with large pictures needs most memory.
    workspace.recycle(keyed);
    if let Cow::Owned(points) = points {
        workspace.recycle(points);
    }
    let mut samples = workspace.empty(merged.iter().map(Vec::len).sum());
    merged.into_iter().for_each(|part| samples.extend_from_slice(&part));
    step()?;
    Ok(samples)
}

/// The Morton codes of the cells of usable points, and the points' indices, which start at `first`.
fn keyed(points: &[Point], first: u32, grid: &SparseGrid) -> Vec<(u64, u32)> {
    let size = grid.dims.map(|v| (v as usize * BLOCK) as f32);
    let key = |(i, point): (u32, &Point)| {
        let at = (point.position - grid.origin) / grid.voxel;
        let usable = point.weight > 0.0
            && (point.weight + point.sigma).is_finite()
            && at.is_finite()
            && point.normal.length() > 0.5;
        let within = usable && (0..3).all(|k| at[k] >= 2.0 && at[k] < size[k] - 3.0);
        within.then(|| {
            let [x, y, z] = (at / MERGED).to_array().map(|v| v as u64);
            (spread(x) | spread(y) << 1 | spread(z) << 2, i)
        })
    };
    (first..).zip(points).filter_map(key).collect()
}

/// The keys of all parts, sorted by the first bits of their codes only, and the ends of jobs of at least [`POINTS_PER_JOB`]
/// keys, but for the last. Keys of the same cell belong to the same job.
fn distributed(
    parts: &[Vec<(u64, u32)>],
    grid: &SparseGrid,
    workspace: &mut Workspace,
) -> (Vec<(u64, u32)>, Vec<usize>) {
    let longest = grid.dims.into_iter().max().unwrap_or(1) as usize * (BLOCK as f32 / MERGED) as usize;
    let dropped = 3 * longest.next_power_of_two().trailing_zeros().saturating_sub(BUCKET_BITS);
    let bucket = |key: u64| (key >> dropped) as usize;
    let mut starts = vec![0; (1 << (3 * BUCKET_BITS)) + 1];
    parts.iter().flatten().for_each(|&(key, _)| starts[bucket(key) + 1] += 1);
    let mut ends = Vec::new();
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
        if starts[i] - ends.last().copied().unwrap_or(0) >= POINTS_PER_JOB {
            ends.push(starts[i]);
        }
    }
    ends.push(starts[starts.len() - 1]);
    let mut keyed = workspace.filled((0, 0), starts[starts.len() - 1]);
    for &(key, i) in parts.iter().flatten() {
        let next = &mut starts[bucket(key)];
        keyed[*next] = (key, i);
        *next += 1;
    }
    (keyed, ends)
}

/// Sorts the keys and merges the points of each cell. The points of a cell are sorted by all of their numbers, so that the order
/// in which they are given does not change the sums.
fn merged_cells(keyed: &mut [(u64, u32)], points: &[Point], grid: &SparseGrid) -> Vec<Sample> {
    let bits = |&(_, i): &(u64, u32)| {
        let p = &points[i as usize];
        let [[x, y, z], [u, v, w]] = [p.position, p.normal].map(|p| p.to_array().map(f32::to_bits));
        ([x, y, z, u, v, w, p.weight.to_bits(), p.sigma.to_bits()], i)
    };
    sort::indexed(keyed);
    let same = |a: &(u64, u32), b: &(u64, u32)| a.0 == b.0;
    // Counted first, so that no memory is taken for more.
    let mut samples = Vec::with_capacity(keyed.chunk_by(same).count());
    let (mut sorted, mut of) = (Vec::new(), Vec::new());
    for cell in keyed.chunk_by(same) {
        sorted.clear();
        sorted.extend(cell.iter().map(bits));
        sort::mostly_short(&mut sorted);
        of.clear();
        of.extend(sorted.iter().map(|&(_, i)| &points[i as usize]));
        samples.push(merged(cell[0].0, &of, grid));
    }
    samples
}

/// Spreads the lowest 21 bits to every third bit (Morton, A Computer Oriented Geodetic Data Base, 1966).
fn spread(v: u64) -> u64 {
    let v = (v | v << 32) & 0x001f_0000_0000_ffff;
    let v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    let v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    let v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// Weighted means of a cell's points. The field of their normals remains the same except for the finest detail.
fn merged(cell: u64, of: &[&Point], grid: &SparseGrid) -> Sample {
    let (mut at, mut normal, mut area, mut sigma) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0.0);
    for point in of {
        at += (point.position - grid.origin) / grid.voxel * point.weight;
        normal += point.normal * (point.weight / point.normal.length());
        area += point.weight;
        sigma += point.weight * point.sigma;
    }
    let count = of.len() as f32;
    Sample { at: at / area, normal: normal / area, sigma: sigma / area, count, area, detail: 0.0, cell }
}

/// Samples for a level from those for the next finer level: samples that are `settled` are merged in cells of twice the
/// size.
pub(super) fn coarser(samples: &[Sample], settled: impl Fn(&Sample) -> bool, workspace: &mut Workspace) -> Vec<Sample> {
    let mut merged: Vec<Sample> = workspace.empty(samples.len() / 2);
    for family in samples.chunk_by(|a, b| a.cell >> 3 == b.cell >> 3) {
        let cell = family[0].cell >> 3;
        let empty = Sample { at: Vec3::ZERO, normal: Vec3::ZERO, sigma: 0.0, count: 0.0, area: 0.0, detail: 0.0, cell };
        let (mut sum, first) = (empty, merged.len());
        for sample in family {
            if settled(sample) {
                sum.at += sample.at * sample.area;
                sum.normal += sample.normal * sample.area;
                sum.sigma += sample.sigma * sample.area;
                sum.count += sample.count;
                sum.area += sample.area;
                sum.detail = max(sum.detail, sample.detail);
            } else {
                merged.push(Sample { cell, ..*sample });
            }
        }
        if sum.area > 0.0 {
            let [at, normal] = [sum.at, sum.normal].map(|v| v / sum.area);
            merged.insert(first, Sample { at, normal, sigma: sum.sigma / sum.area, ..sum });
        }
    }
    merged
}

/// Sum of the autocorrelation of the quadratic B-spline over a plane with one point per square voxel.
const PLANE: f32 = 0.556;

/// Smallest number of points per square voxel for which the density can be measured at a level.
const DENSE: f32 = 1.0;

/// Width of a sample's spline, relative to the spacing of the samples around it.
const SPREAD: f32 = 1.5;

/// Sets the area of surface that each sample represents, in square voxels of the finest level, and its level of detail.
/// Both follow from the density of the samples around it. The surface is then independent of the density, and weights
/// (eq. 3) matter only relative to those of neighbouring points. `step` is called at least four times per level.
pub(super) fn weigh(
    samples: &mut [Sample],
    finest: &SparseGrid,
    levels: usize,
    workspace: &mut Workspace,
    executor: &dyn Executor,
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
        let grid = around(&merged, finest, level, 2.0, executor);
        step()?;
        let density = density(&merged, &grid, scale, workspace, executor, &mut step)?;
        let last = level == levels - 1;
        let weighed = |sample: &Sample| {
            let [count, weight] = Stencil::new(&grid, sample.at * scale, |slot| slot).gather(&density);
            let count = count / PLANE;
            (count >= DENSE || last).then(|| {
                // Converted from square voxels of this level to those of the finest level.
                let area = PLANE * sample.area / weight / (scale * scale);
                let spacing = 1.0 / (scale * sqrt(count));
                let detail = libm::log2f(SPREAD * spacing).clamp(0.0, (levels - 1) as f32);
                (area, detail)
            })
        };
        // Samples for which the density is too low here are moved to the front and wait for the next level.
        let mut left = 0;
        for first in (0..waiting.len()).step_by(SAMPLES_PER_STEP) {
            step()?;
            let batch = first..waiting.len().min(first + SAMPLES_PER_STEP);
            let parts: Vec<&[u32]> = waiting[batch.clone()].chunks(POINTS_PER_JOB).collect();
            let found: Vec<Vec<_>> =
                executor.map(parts.len(), |part| parts[part].iter().map(|&i| weighed(&samples[i as usize])).collect());
            for (n, found) in batch.zip(found.into_iter().flatten()) {
                let i = waiting[n];
                match found {
                    Some(found) => shares[i as usize] = found,
                    None => {
                        waiting[left] = i;
                        left += 1;
                    }
                }
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

/// Number of points and sum of their weights per cubic voxel, smoothed by the B-spline.
fn density(
    samples: &[Sample],
    grid: &SparseGrid,
    scale: f32,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    step: impl FnMut() -> Result<()>,
) -> Result<Vec<[f32; 2]>> {
    let mut density = workspace.filled([0.0; 2], grid.blocks.len() * BLOCK_NODES);
    let contribute = |sample: &Sample, patch: &mut Patch<2>| {
        let stencil = Stencil::new(grid, sample.at * scale, |slot| patch.place(slot));
        for (row, weights) in stencil.rows() {
            row.add(patch.sums(), &weights.map(|weight| [weight * sample.count, weight * sample.area]));
        }
    };
    let add = |first: usize, sums: &[[f32; 2]]| {
        for (density, sum) in density[first..].iter_mut().zip(sums) {
            density[0] += sum[0];
            density[1] += sum[1];
        }
    };
    patch::accumulate(samples, grid, contribute, add, executor, step)?;
    Ok(density)
}

/// Marks the blocks of a level's grid that contain a node within `reach` voxels of a sample.
pub(super) fn mark(samples: &[Sample], dims: [u32; 3], level: usize, reach: f32, executor: &dyn Executor) -> Vec<bool> {
    let scale = 1.0 / (1 << level) as f32;
    let block = |v: f32, k: usize| min(max(v, 0.0) / BLOCK as f32, (dims[k] - 1) as f32) as u32;
    let parts: Vec<&[Sample]> = samples.chunks(POINTS_PER_JOB).collect();
    let reached = executor.map(parts.len(), |part| {
        // Lowest and highest block, each once for samples in a row.
        let mut reached: Vec<[[u32; 3]; 2]> = Vec::new();
        for sample in parts[part] {
            let at = sample.at * scale;
            let range = [at - Vec3::splat(reach), at + Vec3::splat(reach)];
            let range = range.map(|v| core::array::from_fn(|k| block(v[k], k)));
            if reached.last() != Some(&range) {
                reached.push(range);
            }
        }
        reached
    });
    let mut marks = vec![false; (dims[0] * dims[1] * dims[2]) as usize];
    for [low, high] in reached.into_iter().flatten() {
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

/// A level's grid, which stores the blocks around the samples.
fn around(samples: &[Sample], finest: &SparseGrid, level: usize, reach: f32, executor: &dyn Executor) -> SparseGrid {
    let dims = finest.dims.map(|v| v >> level);
    let marks = mark(samples, dims, level, reach, executor);
    let voxel = finest.voxel * (1 << level) as f32;
    SparseGrid::new(finest.origin, voxel, dims, |[x, y, z]| {
        if marks[((z * dims[1] + y) * dims[0] + x) as usize] { 0 } else { SparseGrid::OUTSIDE }
    })
}
