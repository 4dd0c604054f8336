//! Finds the approximate extent of the object in the space between the cameras (§0).

use super::{
    carver::Carver,
    space::{CELLS, cell_corner, cell_edge, half_edge, support},
    support::{keep_objects, needed_support},
};
use crate::{
    error::{Error, Result},
    executor::Executor,
    progress::Progress,
    workspace::Workspace,
};
use alloc::vec::Vec;
use glam::Vec3;

/// The cells of a cube around the rig's origin that may contain the object.
pub(super) struct Search {
    half: f32,
    /// Number of silhouettes that must contain a point of the object in each cell, x fastest. Zero in cells that contain
    /// nothing of it.
    pub needed: Vec<u16>,
    pub lower: Vec3,
    pub upper: Vec3,
}

impl Search {
    /// Subdivides a cube that contains all cameras. Of the cells that no silhouette excludes, those are kept that the
    /// photographs need ([`needed_support`]), if they are connected to one that several of them need.
    pub fn new(
        carvers: &[Carver],
        workspace: &mut Workspace,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let half = half_edge(carvers);
        let support = support(carvers, half, 0, workspace, executor, progress)?;
        let mut needed = needed_support(carvers, &support, half, workspace, executor);
        workspace.recycle(support);
        keep_objects(&mut needed, workspace);
        let (mut lower, mut upper) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let size = cell_edge(half);
        for i in (0..needed.len()).filter(|&i| needed[i] > 0) {
            let corner = cell_corner(i, half);
            (lower, upper) = (lower.min(corner), upper.max(corner + Vec3::splat(size)));
        }
        if lower.x > upper.x { Err(Error::EmptyHull) } else { Ok(Self { half, needed, lower, upper }) }
    }

    /// The smallest number of silhouettes that must contain a point of the object in a cube. `None` if it contains nothing
    /// of it.
    pub fn needed(&self, centre: Vec3, half_edge: f32) -> Option<u32> {
        let scale = CELLS as f32 / (2.0 * self.half);
        let index = |v: f32| ((v + self.half) * scale).clamp(0.0, CELLS as f32 - 1.0) as usize;
        let (a, b) = (centre - Vec3::splat(half_edge), centre + Vec3::splat(half_edge));
        let mut least = None;
        for z in index(a.z)..=index(b.z) {
            for y in index(a.y)..=index(b.y) {
                let row = &self.needed[(z * CELLS + y) * CELLS..][index(a.x)..=index(b.x)];
                let needed = row.iter().filter(|&&needed| needed > 0).map(|&needed| u32::from(needed)).min();
                least = least.into_iter().chain(needed).min();
            }
        }
        least
    }
}
