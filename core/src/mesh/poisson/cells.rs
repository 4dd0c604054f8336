//! The samples merged cell by cell, for the screening term (Kazhdan & Hoppe 2013).

use alloc::vec::Vec;
use glam::Vec3;

use super::profile;
use super::samples::Sample;
use super::spline::{ABSENT, cube};
use crate::executor::Executor;
use crate::grid::{BLOCK_NODES, BLOCKS_PER_JOB, SparseGrid};
use crate::math::{floor, from_ordered, min, ordered};
use crate::sort;
use crate::workspace::Workspace;

/// Cells that one job of an executor makes.
const CELLS_PER_JOB: usize = 4096;

/// The merged points of one cell of the grid. The screening term pulls the surface to their mean position.
pub(super) struct Cell {
    /// Indices of the values at the cell's corners, x fastest.
    pub(super) nodes: [u32; 8],
    /// Trilinear weights of the corners.
    pub(super) shares: [f32; 8],
    /// Area of surface in square voxels.
    pub(super) area: f32,
    /// Mean standard deviation of the points.
    pub(super) sigma: f32,
    /// Target of the interpolated χ at the mean position: its value if the surface passes there with the mean normal.
    /// It differs slightly from 1/2 because χ is curved between the corners.
    pub(super) chi: f32,
}

impl Cell {
    /// The corners in a block: their indices among its nodes, and their weights.
    #[inline]
    pub(super) fn corners_in(&self, slot: usize) -> impl Iterator<Item = (usize, f32)> {
        let first = (slot * BLOCK_NODES) as u32;
        let corners = self.nodes.into_iter().zip(self.shares);
        let corners = corners.map(move |(node, share)| (node.wrapping_sub(first) as usize, share));
        corners.filter(|&(local, _)| local < BLOCK_NODES)
    }

    /// χ at the mean position, interpolated from the corners.
    #[inline]
    pub(super) fn value(&self, chi: &[f32]) -> f32 {
        let mut sum = 0.0;
        for (&node, share) in self.nodes.iter().zip(self.shares) {
            sum += share * chi[node as usize];
        }
        sum
    }

    /// The blocks in which the cell has corners, each once.
    fn blocks(&self) -> impl Iterator<Item = u32> {
        let blocks = self.nodes.map(|node| node / BLOCK_NODES as u32);
        (0..blocks.len()).filter(move |&i| !blocks[..i].contains(&blocks[i])).map(move |i| blocks[i])
    }
}

/// The cells of a level that contain samples.
#[derive(Default)]
pub(super) struct Cells {
    cells: Vec<Cell>,
    /// For each stored block, the start of its list in `list`; then the total length.
    starts: Vec<u32>,
    /// For each stored block, the cells with a corner in it, in ascending order. Jobs add what cells contribute to the nodes
    /// of their own blocks.
    list: Vec<u32>,
}

/// Sums over the samples of a cell.
struct Sums {
    /// The cell's first corner.
    corner: [i32; 3],
    area: f32,
    /// Area times the offset from the first corner.
    offset: Vec3,
    /// Area times normal.
    normal: Vec3,
    /// Area times standard deviation.
    sigma: f32,
}

impl Sums {
    /// `None` if a corner is not stored, or without area.
    fn cell(&self, grid: &SparseGrid) -> Option<Cell> {
        let nodes: [u32; 8] = cube::<2, 8>(grid, self.corner, |slot| slot);
        if self.area <= 0.0 || nodes.contains(&ABSENT) {
            return None;
        }
        let offset = self.offset.to_array().map(|v| v / self.area);
        let share = |i: usize, k: usize| if i >> k & 1 == 1 { offset[k] } else { 1.0 - offset[k] };
        let shares: [f32; 8] = core::array::from_fn(|i| share(i, 0) * share(i, 1) * share(i, 2));
        let normal = self.normal.normalize_or_zero();
        let chi = (0..8).fold(0.5, |sum, i| {
            let outward = Vec3::from_array(core::array::from_fn(|k| (i >> k & 1) as f32 - offset[k])).dot(normal);
            sum + shares[i] * profile::chi(-outward)
        });
        // A sample of a coarser level represents more surface than this cell contains.
        Some(Cell { nodes, shares, area: min(self.area, 1.0), sigma: self.sigma / self.area, chi })
    }
}

impl Cells {
    /// Merges the samples in the cells of the grid.
    pub(super) fn new(
        samples: &[Sample],
        grid: &SparseGrid,
        level: usize,
        workspace: &mut Workspace,
        executor: &dyn Executor,
    ) -> Self {
        let sums = sums(samples, grid, level, workspace);
        let parts: Vec<&[Sums]> = sums.chunks(CELLS_PER_JOB).collect();
        let made: Vec<Vec<Cell>> =
            executor.map(parts.len(), |part| parts[part].iter().filter_map(|sums| sums.cell(grid)).collect());
        let mut cells = workspace.empty(sums.len());
        cells.extend(made.into_iter().flatten());
        workspace.recycle(sums);
        Self::listed(cells, grid.blocks.len(), workspace)
    }

    /// Lists the cells of each block.
    fn listed(cells: Vec<Cell>, blocks: usize, workspace: &mut Workspace) -> Self {
        let mut starts = workspace.filled(0u32, blocks + 1);
        cells.iter().flat_map(Cell::blocks).for_each(|block| starts[block as usize + 1] += 1);
        for block in 0..blocks {
            starts[block + 1] += starts[block];
        }
        let mut list = workspace.filled(0u32, starts[blocks] as usize);
        let mut next = workspace.empty(blocks);
        next.extend_from_slice(&starts[..blocks]);
        for (i, cell) in (0..).zip(&cells) {
            for block in cell.blocks() {
                let next = &mut next[block as usize];
                list[*next as usize] = i;
                *next += 1;
            }
        }
        workspace.recycle(next);
        Self { cells, starts, list }
    }

    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.cells);
        workspace.recycle(self.starts);
        workspace.recycle(self.list);
    }

    /// The cells with a corner in a block.
    pub(super) fn of_block(&self, slot: usize) -> impl Iterator<Item = &Cell> {
        self.list[self.starts[slot] as usize..self.starts[slot + 1] as usize].iter().map(|&i| &self.cells[i as usize])
    }

    /// Calls `add` for each corner of each cell with the field's value there, the cell and the corner's weight. At every node
    /// the cells come in ascending order.
    pub(super) fn scatter<T: Send>(
        &self,
        field: &mut [T],
        executor: &dyn Executor,
        add: impl Fn(&mut T, &Cell, f32) + Sync,
    ) {
        executor.map_parts(field.chunks_mut(BLOCKS_PER_JOB * BLOCK_NODES), |i, part| {
            for (slot, block) in (i * BLOCKS_PER_JOB..).zip(part.chunks_exact_mut(BLOCK_NODES)) {
                for cell in self.of_block(slot) {
                    cell.corners_in(slot).for_each(|(local, share)| add(&mut block[local], cell, share));
                }
            }
        });
    }

    /// Median of a field at the points, weighted by area. `None` without points. Stray points lie on both sides of the
    /// surface, but not outside the envelope, so that a mean would be biased to the inside.
    pub(super) fn median(&self, field: &[f32], workspace: &mut Workspace) -> Option<f32> {
        let key = |cell: &Cell| u64::from(ordered(cell.value(field))) << 32 | u64::from(cell.area.to_bits());
        let area = |key: u64| f64::from(f32::from_bits(key as u32));
        let mut keys: Vec<u64> = workspace.empty(self.cells.len());
        keys.extend(self.cells.iter().map(key));
        sort::numbers(&mut keys);
        let half = 0.5 * keys.iter().fold(0.0, |sum, &key| sum + area(key));
        let mut sum = 0.0;
        let middle = keys.iter().find(|&&key| {
            sum += area(key);
            sum >= half
        });
        let median = middle.map(|&key| from_ordered((key >> 32) as u32));
        workspace.recycle(keys);
        median
    }
}

fn sums(samples: &[Sample], grid: &SparseGrid, level: usize, workspace: &mut Workspace) -> Vec<Sums> {
    const NONE: u32 = u32::MAX;
    let scale = 1.0 / (1 << level) as f32;
    let mut index = workspace.filled(NONE, grid.blocks.len() * BLOCK_NODES);
    let mut sums: Vec<Sums> = workspace.take();
    for sample in samples {
        let at = sample.at * scale;
        let corner = [at.x, at.y, at.z].map(floor);
        let (slot, local) = grid.locate(corner[0], corner[1], corner[2]);
        if slot >= SparseGrid::INSIDE {
            continue;
        }
        let entry = &mut index[slot as usize * BLOCK_NODES + local];
        if *entry == NONE {
            *entry = sums.len() as u32;
            sums.push(Sums { corner, area: 0.0, offset: Vec3::ZERO, normal: Vec3::ZERO, sigma: 0.0 });
        }
        let area = sample.area * scale * scale;
        let sum = &mut sums[*entry as usize];
        sum.area += area;
        sum.offset += (at - Vec3::from_array(corner.map(|v| v as f32))) * area;
        sum.normal += sample.normal * area;
        sum.sigma += area * sample.sigma;
    }
    workspace.recycle(index);
    sums
}
