//! Judges the blocks of the hull's grid (§0): outside, inside, or to be stored because the surface may pass.

use super::{
    carver::Carver,
    judge::{Verdict, judge},
    memory::check_grid,
    search::Search,
};
use crate::{
    error::Result,
    executor::Executor,
    grid::{BLOCK, SparseGrid},
    progress::{self, Progress},
    stage::Stage,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use glam::Vec3;

/// Layers that are judged between two checks of the memory that the stored blocks will need.
const LAYERS: u32 = 32;

/// The grid to judge, and what it is judged by.
pub(super) struct Judging<'a> {
    pub views: &'a [View],
    pub carvers: &'a [Carver],
    pub search: &'a Search,
    pub origin: Vec3,
    pub voxel: f32,
    /// Size in blocks.
    pub dims: [u32; 3],
    /// Largest number of bytes.
    pub limit: Option<u64>,
}

/// The grid with its stored blocks, and for each of them what [`super::VisualHull`] needs.
pub(super) struct Judged {
    pub grid: SparseGrid,
    /// The start of each block's list in `carver_lists`; then the total length.
    pub list_starts: Vec<u32>,
    pub carver_lists: Vec<u16>,
    pub needed: Vec<u32>,
}

/// The blocks of one layer, x fastest.
struct Layer {
    verdicts: Vec<Verdict>,
    /// For each stored block, the length of its list in `lists`.
    lengths: Vec<u16>,
    lists: Vec<u16>,
    needed: Vec<u32>,
}

impl Judging<'_> {
    /// Judges all blocks, layer by layer.
    ///
    /// # Errors
    /// [`crate::Error::OutOfMemory`] and [`crate::Error::Cancelled`].
    pub fn judge(&self, workspace: &mut Workspace, executor: &dyn Executor, progress: &dyn Progress) -> Result<Judged> {
        let mut layers: Vec<Layer> = Vec::with_capacity(self.dims[2] as usize);
        let mut stored = 0;
        while (layers.len() as u32) < self.dims[2] {
            let first = layers.len() as u32;
            let count = LAYERS.min(self.dims[2] - first);
            let judged = executor.map(count as usize, |i| self.layer(first + i as u32, progress));
            for layer in judged {
                let layer = layer?;
                stored += layer.needed.len();
                self.check(stored)?;
                layers.push(layer);
            }
        }

        let (mut list_starts, mut needed) = (workspace.empty(stored + 1), workspace.empty(stored));
        let mut carver_lists = workspace.empty(layers.iter().map(|layer| layer.lists.len()).sum());
        list_starts.push(0);
        for layer in &layers {
            let starts = layer.lengths.iter().scan(carver_lists.len() as u32, |end, &length| {
                *end += u32::from(length);
                Some(*end)
            });
            list_starts.extend(starts);
            carver_lists.extend_from_slice(&layer.lists);
            needed.extend_from_slice(&layer.needed);
        }
        let mut verdicts = layers.iter().flat_map(|layer| &layer.verdicts);
        let grid = SparseGrid::new(self.origin, self.voxel, self.dims, |_| match verdicts.next() {
            Some(Verdict::Boundary) => 0,
            Some(Verdict::Inside) => SparseGrid::INSIDE,
            Some(Verdict::Outside) | None => SparseGrid::OUTSIDE,
        });
        Ok(Judged { grid, list_starts, carver_lists, needed })
    }

    fn layer(&self, z: u32, progress: &dyn Progress) -> Result<Layer> {
        progress::step(progress, Stage::Hull, z, 2 * self.dims[2])?;
        let [w, h, _] = self.dims;
        let edge = self.voxel * BLOCK as f32;
        // A block is judged by a ball that contains its nodes and its cells, up to the first nodes of the next block.
        let radius = 0.5 * edge * 1.7320508 + self.voxel;
        let mut layer = Layer {
            verdicts: Vec::with_capacity((w * h) as usize),
            lengths: Vec::new(),
            lists: Vec::new(),
            needed: Vec::new(),
        };
        let mut crossing = Vec::new();
        for y in 0..h {
            self.check(layer.needed.len())?;
            for x in 0..w {
                let centre = self.origin + Vec3::new(x as f32 + 0.5, y as f32 + 0.5, z as f32 + 0.5) * edge;
                let Some(least) = self.search.needed(centre, 0.5 * edge + self.voxel) else {
                    layer.verdicts.push(Verdict::Outside);
                    continue;
                };
                let (verdict, containing, _) = judge(self.carvers, centre, radius, (least, 0), &mut crossing);
                layer.verdicts.push(verdict);
                if verdict == Verdict::Boundary {
                    layer.lists.extend_from_slice(&crossing);
                    layer.lengths.push(crossing.len() as u16);
                    layer.needed.push(least.saturating_sub(containing));
                }
            }
        }
        Ok(layer)
    }

    fn check(&self, stored: usize) -> Result<()> {
        let table = self.dims.iter().map(|&n| u64::from(n)).product();
        check_grid(self.views, table, stored as u64, self.limit)
    }
}
