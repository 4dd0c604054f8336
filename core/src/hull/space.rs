//! The space between the cameras, as the cells of a cube, and which of them silhouettes may contain.

use super::{
    carver::Carver,
    judge::{Verdict, judge},
};
use crate::{
    error::Result,
    executor::Executor,
    math::min,
    progress::{self, Progress},
    stage::Stage,
    workspace::Workspace,
};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Smallest number of silhouettes that must contain a point of the object.
pub(super) const MIN_SILHOUETTES: u32 = 2;

/// Number of cells along an edge of the searched cube.
pub(super) const CELLS: usize = 128;
/// Ratio of a cube's diagonal to its edge: √3.
const DIAGONAL: f32 = 1.7320508;

/// The object is nearer to the rig's origin than this many times what a camera sees there, as width plus height of its picture.
/// Only where cameras see less than 6° this is less than the distance of the cameras.
const SEEN: f32 = 6.0;

/// The cells of a cube around the rig's origin that the object may occupy even if some silhouettes wrongly exclude it.
pub(super) struct Space {
    half: f32,
    /// Number of views whose silhouette a cell may lie in, x fastest. Zero if more views exclude it than are tolerated.
    support: Vec<u16>,
}

impl Space {
    /// The cells that at most `tolerated` views exclude.
    pub fn new(
        carvers: &[Carver],
        tolerated: u32,
        workspace: &mut Workspace,
        executor: &dyn Executor,
        progress: &dyn Progress,
    ) -> Result<Self> {
        let half = half_edge(carvers);
        Ok(Self { half, support: support(carvers, half, tolerated, workspace, executor, progress)? })
    }

    /// Edge of a cell, in scene units.
    pub fn cell(&self) -> f32 {
        cell_edge(self.half)
    }

    /// Distance from a point beyond which nothing is searched, in scene units.
    pub fn reach(&self, from: Vec3) -> f32 {
        from.length() + DIAGONAL * self.half
    }

    /// Whether a point may belong to the object.
    pub fn contains(&self, p: Vec3) -> bool {
        let q = (p + Vec3::splat(self.half)) / self.cell();
        if !(q.min_element() >= 0.0 && q.max_element() < CELLS as f32) {
            return false;
        }
        self.support[(q.z as usize * CELLS + q.y as usize) * CELLS + q.x as usize] > 0
    }

    /// Returns its memory to a workspace.
    pub fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.support);
    }
}

/// Half the edge of a cube around the rig's origin that contains the object, in scene units. It contains all cameras, too,
/// unless they stand so far away that what they see is a small part of that.
pub(super) fn half_edge(carvers: &[Carver]) -> f32 {
    let largest = |of: fn(&Carver) -> f32| carvers.iter().map(of).fold(0.0, f32::max);
    let farthest = largest(|c| c.camera.centre.length());
    let seen = largest(|c| c.camera.footprint(c.camera.centre.length()) * (c.camera.width + c.camera.height) as f32);
    min(farthest * 1.2, seen * SEEN)
}

/// Edge of a cell, in scene units, from half the edge of the cube.
pub(super) fn cell_edge(half: f32) -> f32 {
    2.0 * half / CELLS as f32
}

/// The lowest corner of a cell, relative to the rig's origin.
pub(super) fn cell_corner(i: usize, half: f32) -> Vec3 {
    let [x, y, z] = coordinates(i).map(|v| v as f32);
    Vec3::new(x, y, z) * cell_edge(half) - Vec3::splat(half)
}

/// Numbers of a cell along x, y and z.
pub(super) fn coordinates(i: usize) -> [usize; 3] {
    [i % CELLS, i / CELLS % CELLS, i / (CELLS * CELLS)]
}

/// For every cell, the number of views whose silhouette it may lie in, or zero if more than `tolerated` views exclude
/// it.
pub(super) fn support(
    carvers: &[Carver],
    half: f32,
    tolerated: u32,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<u16>> {
    let mut support = workspace.filled(0u16, CELLS * CELLS * CELLS);
    let judging = Judging { carvers, half, tolerated };
    let whole = Cube { corner: [0; 3], cells: CELLS };
    let mut parts = Vec::new();
    judging.subdivide(whole, PART, progress, |part, _| parts.push(part))?;
    let found = executor.map(parts.len(), |i| {
        let mut found: Vec<(u32, u16)> = Vec::new();
        judging.subdivide(parts[i], 1, progress, |Cube { corner: [x, y, z], .. }, supporting| {
            found.push((((z * CELLS + y) * CELLS + x) as u32, supporting as u16));
        })?;
        Ok(found)
    });
    for part in found {
        for (cell, supporting) in part? {
            support[cell as usize] = supporting;
        }
    }
    Ok(support)
}

/// Cells along an edge of the parts that are searched independently of each other.
const PART: usize = CELLS / 8;

/// A cube of cells.
#[derive(Clone, Copy)]
struct Cube {
    /// Numbers of its lowest cell along x, y and z.
    corner: [usize; 3],
    /// Cells along an edge.
    cells: usize,
}

/// Judges cubes of cells.
struct Judging<'a> {
    carvers: &'a [Carver],
    half: f32,
    tolerated: u32,
}

impl Judging<'_> {
    /// Subdivides a cube into cubes of `smallest` cells, and passes those that are not outside to `found`, with the number of
    /// views whose silhouette they may lie in.
    fn subdivide(
        &self,
        whole: Cube,
        smallest: usize,
        progress: &dyn Progress,
        mut found: impl FnMut(Cube, u32),
    ) -> Result<()> {
        let mut crossing = Vec::new();
        let mut stack = vec![whole];
        let mut visited = 0u32;
        while let Some(Cube { corner, cells }) = stack.pop() {
            if visited.is_multiple_of(4096) {
                progress::step(progress, Stage::Hull, 0, 1)?;
            }
            visited += 1;
            let edge = 2.0 * self.half * cells as f32 / CELLS as f32;
            let [x, y, z] = corner.map(|v| v as f32 * 2.0 * self.half / CELLS as f32 - self.half + 0.5 * edge);
            let (centre, radius) = (Vec3::new(x, y, z), 0.5 * edge * DIAGONAL);
            let (verdict, _, supporting) =
                judge(self.carvers, centre, radius, (MIN_SILHOUETTES, self.tolerated), &mut crossing);
            if verdict == Verdict::Outside {
                continue;
            }
            if cells == smallest {
                found(Cube { corner, cells }, supporting);
                continue;
            }
            let step = cells / 2;
            for k in 0..8 {
                let at = |axis: usize| corner[axis] + if k >> axis & 1 == 0 { 0 } else { step };
                stack.push(Cube { corner: [at(0), at(1), at(2)], cells: step });
            }
        }
        Ok(())
    }
}
