//! Carving (§0): finds the blocks that the hull's surface may pass, and evaluates the signed distance at their nodes.

use super::{
    block_distances::BlockDistances,
    blocks::{Judged, Judging},
    carver::{Carver, carvers},
    memory::check_grid,
    point_distance::Group,
    search::Search,
    visual_hull::VisualHull,
};
use crate::{
    error::{Error, Result},
    executor::{Executor, Serial},
    grid::{BLOCK, BLOCK_NODES, BLOCKS_PER_JOB, SparseGrid},
    progress::{self, Progress},
    rig::MIN_VIEWS,
    simd::Simd,
    sort::short,
    stage::Stage,
    view::View,
    workspace::Workspace,
};
use alloc::{format, vec::Vec};
use glam::Vec3;

/// Most blocks in the grid's bounding box. A person that fills pictures of 8000 pixels has as many.
const MAX_BLOCKS: u64 = 1 << 28;

/// An object is at most so many times as long as the largest picture shows of it, at the footprint of the median view.
const MAX_PICTURES: f32 = 16.0;
/// Any grid may have so many blocks along an edge: those of an object that fills the searched space.
const SMALLEST_EDGE: u32 = 64;

/// Parameters of the visual hull (§0).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct HullParams {
    /// Spacing of the grid's nodes, in pixels of footprint at the object.
    pub voxel_pixels: f32,
}

impl VisualHull {
    /// Carves the hull.
    ///
    /// # Errors
    /// [`Error::EmptyHull`] if no point lies inside all silhouettes that see it, [`Error::TooFewViews`] if fewer than
    /// three views have a silhouette, [`Error::Cameras`] if the silhouettes bound far more space than cameras resolve,
    /// [`Error::Cancelled`].
    pub fn new(views: &[View], params: &HullParams, progress: &dyn Progress) -> Result<Self> {
        Self::with_workspace(views, params, None, &mut Workspace::default(), &Serial, progress)
    }

    /// [`Self::new`] with memory for reuse, and with at most `limit` bytes (see [`crate::memory`]).
    ///
    /// # Errors
    /// As for [`Self::new`], and [`Error::OutOfMemory`].
    pub fn with_workspace(
        views: &[View],
        params: &HullParams,
        limit: Option<u64>,
        workspace: &mut Workspace,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let carvers = carvers(views);
        if (carvers.len() as u32) < MIN_VIEWS {
            return Err(Error::TooFewViews { given: carvers.len() as u32, needed: MIN_VIEWS });
        }
        let search = Search::new(&carvers, workspace, executor, progress)?;
        let (lower, upper) = (search.lower, search.upper);
        let footprint = footprint(&carvers, (lower + upper) * 0.5).ok_or(Error::EmptyHull)?;
        let voxel = footprint * params.voxel_pixels;
        let edge = voxel * BLOCK as f32;
        // A margin of one block on every side, so that the surface is closed within the grid.
        let origin = lower - Vec3::splat(edge);
        let size = (upper - lower) / edge;
        let dims = [size.x, size.y, size.z].map(|s| (libm::ceilf(s) as u32).saturating_add(2));

        let longest = longest_edge(&carvers, params.voxel_pixels);
        let table = dims.iter().map(|&n| u64::from(n)).fold(1, u64::saturating_mul);
        if table > MAX_BLOCKS || dims.iter().any(|&n| n > longest) {
            return Err(too_large(dims));
        }
        check_grid(views, table, 0, limit)?;
        let judging = Judging { views, carvers: &carvers, search: &search, origin, voxel, dims, limit };
        let Judged { grid, list_starts, carver_lists, needed } = judging.judge(workspace, executor, progress)?;
        workspace.recycle(search.needed);

        let mut values = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
        let hull = VisualHull {
            groups: Group::all(&carvers),
            simd: Simd::detect(),
            carvers,
            grid,
            values: Vec::new(),
            list_starts,
            carver_lists,
            needed,
            lower: Vec3::INFINITY,
            upper: Vec3::NEG_INFINITY,
            footprint,
        };
        let parts = values.chunks_mut(BLOCKS_PER_JOB * BLOCK_NODES);
        let count = parts.len() as u32;
        let bounds = executor.map_parts(parts, |i, part| {
            progress::step(progress, Stage::Hull, count + i as u32, 2 * count)?;
            Ok(hull.evaluate(i * BLOCKS_PER_JOB, part))
        });
        let (mut lower, mut upper) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for part in bounds {
            let part = part?;
            (lower, upper) = (lower.min(part.0), upper.max(part.1));
        }
        if lower.x > upper.x {
            return Err(Error::EmptyHull);
        }
        let margin = Vec3::splat(voxel);
        Ok(VisualHull { values, lower: lower - margin, upper: upper + margin, ..hull })
    }

    /// Evaluates the signed distance at the nodes of the stored blocks from slot `first` on, for as many as `values` has.
    /// Returns the bounds of the nodes inside.
    fn evaluate(&self, first: usize, values: &mut [f32]) -> (Vec3, Vec3) {
        let voxel = self.grid.voxel;
        let (mut lower, mut upper) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (slot, values) in (first..).zip(values.as_chunks_mut().0) {
            self.simd.run(BlockDistances { hull: self, slot, values });
            for (local, value) in values.iter_mut().enumerate() {
                *value = value.clamp(-4.0 * voxel, 4.0 * voxel);
                if *value > 0.0 {
                    let p = block_node(&self.grid, slot, local);
                    (lower, upper) = (lower.min(p), upper.max(p));
                }
            }
        }
        (lower, upper)
    }
}

/// Silhouettes that bound so much space contradict the calibration.
fn too_large(dims: [u32; 3]) -> Error {
    let [x, y, z] = dims.map(|n| u64::from(n) * BLOCK as u64);
    let problem = format!(
        "the silhouettes bound a space of {x} x {y} x {z} voxels, far more than cameras resolve: check that the cameras look \
         at one object from several sides, and that masks and calibration belong together"
    );
    Error::Cameras { problem }
}

/// Most blocks along an edge of the grid. The footprint is that of the median view, whose picture shows the object or a part
/// of it.
fn longest_edge(carvers: &[Carver], voxel_pixels: f32) -> u32 {
    let side = carvers.iter().map(|c| c.camera.width.max(c.camera.height)).max().unwrap_or(0);
    let blocks = MAX_PICTURES * side as f32 / (voxel_pixels * BLOCK as f32);
    // Coordinates of blocks have 16 bits.
    (libm::ceilf(blocks) as u32).saturating_add(SMALLEST_EDGE).min(u32::from(u16::MAX))
}

/// Median over the views of the footprint at a point. `None` if no view has it in front, or if it is not a positive number.
fn footprint(carvers: &[Carver], p: Vec3) -> Option<f32> {
    // The bits of positive numbers sort like the numbers.
    let mut sizes: Vec<u32> = carvers
        .iter()
        .filter_map(|c| {
            let depth = c.camera.depth(p);
            (depth > 0.0).then(|| c.camera.footprint(depth).to_bits())
        })
        .collect();
    short(&mut sizes);
    let median = f32::from_bits(*sizes.get(sizes.len() / 2)?);
    (median > 0.0 && median.is_finite()).then_some(median)
}

/// Position of a node of a stored block.
fn block_node(grid: &SparseGrid, slot: usize, local: usize) -> Vec3 {
    debug_assert!(local < BLOCK_NODES);
    let [x, y, z] = grid.blocks[slot].map(|v| i32::from(v) * BLOCK as i32);
    let l = local as i32;
    let (b, m) = (BLOCK.trailing_zeros(), BLOCK as i32 - 1);
    grid.node(x + (l & m), y + ((l >> b) & m), z + (l >> (2 * b)))
}
