//! Finds the approximate extent of the object in the space between the cameras (§0).

use super::{
    carver::Carver,
    judge::{Verdict, judge},
};
use crate::{
    error::{Error, Result},
    progress::{self, Progress},
    stage::Stage,
    workspace::Workspace,
};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Smallest number of silhouettes that must contain a point of the object.
const MIN_SILHOUETTES: u32 = 2;

/// Number of cells along an edge of the searched cube.
const CELLS: usize = 128;
/// Ratio of a cube's diagonal to its edge: √3.
const DIAGONAL: f32 = 1.7320508;

/// Content of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Cell {
    /// Outside the hull.
    Empty,
    /// A group of cells that too few silhouettes support.
    Stray,
    /// Possibly part of the object.
    Object,
}

/// The cells of a cube around the rig's origin that may contain the object.
pub(super) struct Search {
    half: f32,
    /// Content of each cell, x fastest.
    pub cells: Vec<Cell>,
    pub lower: Vec3,
    pub upper: Vec3,
    /// Number of silhouettes that must contain a point of the object.
    pub needed: u32,
}

impl Search {
    /// Subdivides a cube that contains all cameras.
    ///
    /// Where only few views look, their silhouettes may agree by accident: between two cameras that face each other,
    /// the cones of both silhouettes overlap all the way. A cell therefore needs the support of at least two
    /// silhouettes, and of at least two fifths of the largest support that any cell has. Of the connected groups of
    /// such cells, those are kept in which some cell has at least half of the largest support.
    pub fn new(carvers: &[Carver], workspace: &mut Workspace, progress: &dyn Progress) -> Result<Self> {
        let half = carvers.iter().map(|c| c.camera.centre.length()).fold(0.0, f32::max) * 1.2;
        let support = support(carvers, half, workspace, progress)?;
        let largest = support.iter().copied().max().unwrap_or(0);
        let needed = (2 * u32::from(largest)).div_ceil(5).max(MIN_SILHOUETTES);
        let cells = classify(&support, needed, largest, workspace);
        workspace.recycle(support);
        let (mut lower, mut upper) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let size = 2.0 * half / CELLS as f32;
        for (i, _) in cells.iter().enumerate().filter(|&(_, &cell)| cell == Cell::Object) {
            let [x, y, z] = coordinates(i).map(|v| v as f32);
            let corner = Vec3::new(x, y, z) * size - Vec3::splat(half);
            (lower, upper) = (lower.min(corner), upper.max(corner + Vec3::splat(size)));
        }
        if lower.x > upper.x { Err(Error::EmptyHull) } else { Ok(Self { half, cells, lower, upper, needed }) }
    }

    /// Whether a cube may contain a part of the object.
    pub fn touches(&self, centre: Vec3, half_edge: f32) -> bool {
        let scale = CELLS as f32 / (2.0 * self.half);
        let index = |v: f32| ((v + self.half) * scale).clamp(0.0, CELLS as f32 - 1.0) as usize;
        let (a, b) = (centre - Vec3::splat(half_edge), centre + Vec3::splat(half_edge));
        (index(a.z)..=index(b.z)).any(|z| {
            (index(a.y)..=index(b.y))
                .any(|y| (index(a.x)..=index(b.x)).any(|x| self.cells[(z * CELLS + y) * CELLS + x] == Cell::Object))
        })
    }
}

fn coordinates(i: usize) -> [usize; 3] {
    [i % CELLS, i / CELLS % CELLS, i / (CELLS * CELLS)]
}

/// For every cell, the number of views whose silhouette it may lie in, or zero if some view excludes it.
fn support(carvers: &[Carver], half: f32, workspace: &mut Workspace, progress: &dyn Progress) -> Result<Vec<u16>> {
    let mut support = workspace.filled(0u16, CELLS * CELLS * CELLS);
    let mut crossing = Vec::new();
    let mut stack = vec![([0usize; 3], CELLS)];
    let mut visited = 0u32;
    while let Some((corner, cells)) = stack.pop() {
        visited += 1;
        if visited.is_multiple_of(4096) {
            progress::step(progress, Stage::Hull, 0, 1)?;
        }
        let edge = 2.0 * half * cells as f32 / CELLS as f32;
        let [x, y, z] = corner.map(|v| v as f32 * 2.0 * half / CELLS as f32 - half + 0.5 * edge);
        let (verdict, _, supporting) =
            judge(carvers, Vec3::new(x, y, z), 0.5 * edge * DIAGONAL, MIN_SILHOUETTES, &mut crossing);
        if verdict == Verdict::Outside {
            continue;
        }
        if cells == 1 {
            let [x, y, z] = corner;
            support[(z * CELLS + y) * CELLS + x] = supporting as u16;
            continue;
        }
        let step = cells / 2;
        for k in 0..8 {
            let at = |axis: usize| corner[axis] + if k >> axis & 1 == 0 { 0 } else { step };
            stack.push(([at(0), at(1), at(2)], step));
        }
    }
    Ok(support)
}

/// Finds the 26-connected groups of cells with a support of at least `needed`. Groups in which some cell has at least
/// half of the support `largest` belong to the object.
fn classify(support: &[u16], needed: u32, largest: u16, workspace: &mut Workspace) -> Vec<Cell> {
    let mut cells = workspace.filled(Cell::Empty, support.len());
    let mut group: Vec<u32> = workspace.take();
    for first in 0..support.len() {
        if u32::from(support[first]) < needed || cells[first] != Cell::Empty {
            continue;
        }
        cells[first] = Cell::Stray;
        group.clear();
        group.push(first as u32);
        let (mut next, mut best) = (0, 0);
        while next < group.len() {
            let i = group[next] as usize;
            next += 1;
            best = support[i].max(best);
            let [x, y, z] = coordinates(i);
            let range = |v: usize| v.saturating_sub(1)..(v + 2).min(CELLS);
            for z in range(z) {
                for y in range(y) {
                    for x in range(x) {
                        let j = (z * CELLS + y) * CELLS + x;
                        if u32::from(support[j]) >= needed && cells[j] == Cell::Empty {
                            cells[j] = Cell::Stray;
                            group.push(j as u32);
                        }
                    }
                }
            }
        }
        if 2 * best >= largest {
            group.iter().for_each(|&i| cells[i as usize] = Cell::Object);
        }
    }
    workspace.recycle(group);
    cells
}
