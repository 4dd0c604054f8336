//! Which cells of the searched space the photographs need.
//!
//! Where few views look, their silhouettes may agree by accident: between two cameras that face each other, the cones of
//! both silhouettes overlap all the way. Such a cell is no part of the object, because every ray through it also passes
//! a cell that more silhouettes contain. A limb that few cameras see looks different: on some of its rays there is
//! nothing better.

use super::{
    carver::Carver,
    space::{CELLS, MIN_SILHOUETTES, cell_corner, cell_edge, coordinates},
};
use crate::{executor::Executor, workspace::Workspace};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Number of views on whose rays some cell of an object is the best one. With few views it is one less than their number.
const NEEDED_BY: usize = 3;
/// So many silhouettes do not contain a place by accident, however many contain others.
const SUFFICIENT: u16 = 8;
/// Cells that one job of an executor looks at.
const CELLS_PER_JOB: usize = 1024;
/// Marks a cell that is the best one on the rays of enough views.
const BEST: u16 = 1 << 15;

/// For each view the largest support on its rays. Rays are gathered in squares as large as a cell at the origin.
struct Rays<'a> {
    carver: &'a Carver,
    /// Edge of a square, in pixels.
    edge: f32,
    width: usize,
    height: usize,
    best: Vec<u16>,
}

impl<'a> Rays<'a> {
    fn new(carver: &'a Carver, cell: f32) -> Self {
        let camera = &carver.camera;
        let edge = (cell / camera.footprint(camera.centre.length())).clamp(4.0, camera.width as f32);
        let squares = |pixels: u32| (pixels as f32 / edge) as usize + 1;
        let (width, height) = (squares(camera.width), squares(camera.height));
        Self { carver, edge, width, height, best: vec![0; width * height] }
    }

    /// The square to which a point projects, if its silhouette may contain it.
    fn square(&self, p: Vec3, cell: f32) -> Option<usize> {
        let q = self.carver.camera.project(p);
        let within = q.z > 0.0 && q.x >= 0.0 && q.y >= 0.0;
        let (x, y) = ((q.x / self.edge) as usize, (q.y / self.edge) as usize);
        let inside = within && x < self.width && y < self.height;
        let reach = cell / self.carver.camera.footprint(q.z);
        let contains = inside && self.carver.silhouette.sample(q.x, q.y).is_some_and(|d| d > -reach);
        contains.then(|| y * self.width + x)
    }
}

/// For each cell, the number of silhouettes that must contain a point of the object: more than half of what the best cell
/// has on that ray through the cell on which the best cell is worst, or [`SUFFICIENT`]. Zero for cells whose own `support`
/// is less. Cells that are the best ones on the rays of enough views are marked by [`BEST`].
pub(super) fn needed_support(
    carvers: &[Carver],
    support: &[u16],
    half: f32,
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Vec<u16> {
    let cell = cell_edge(half);
    let centre = |i: u32| cell_corner(i as usize, half) + Vec3::splat(0.5 * cell);
    let occupied: Vec<u32> = (0..support.len()).filter(|&i| support[i] > 0).map(|i| i as u32).collect();
    let rays: Vec<Rays> = executor.map(carvers.len(), |c| {
        let mut rays = Rays::new(&carvers[c], cell);
        for &i in &occupied {
            if let Some(square) = rays.square(centre(i), cell) {
                rays.best[square] = rays.best[square].max(support[i as usize]);
            }
        }
        rays
    });
    let enough = NEEDED_BY.min(carvers.len().saturating_sub(1));
    let needed_in = |i: u32| {
        let (own, p) = (support[i as usize], centre(i));
        let bests = || rays.iter().filter_map(|rays| Some(rays.best[rays.square(p, cell)?]));
        let least = bests().min().unwrap_or(u16::MAX);
        let more_than_half = (least / 2 + 1).clamp(MIN_SILHOUETTES as u16, SUFFICIENT);
        if own < more_than_half {
            return 0;
        }
        let mark = if bests().filter(|&best| best == own).count() >= enough { BEST } else { 0 };
        more_than_half | mark
    };
    let mut needed = workspace.filled(0u16, support.len());
    let parts: Vec<&[u32]> = occupied.chunks(CELLS_PER_JOB).collect();
    let found = executor.map(parts.len(), |part| parts[part].iter().map(|&i| needed_in(i)).collect::<Vec<u16>>());
    for (&i, found) in occupied.iter().zip(found.into_iter().flatten()) {
        needed[i as usize] = found;
    }
    needed
}

/// Removes the 26-connected groups of cells that have no marked cell, and the marks.
pub(super) fn keep_objects(needed: &mut [u16], workspace: &mut Workspace) {
    let mut visited = workspace.filled(false, needed.len());
    let mut group: Vec<u32> = workspace.take();
    for first in 0..needed.len() {
        if needed[first] == 0 || visited[first] {
            continue;
        }
        visited[first] = true;
        group.clear();
        group.push(first as u32);
        let (mut next, mut is_object) = (0, false);
        while next < group.len() {
            let i = group[next] as usize;
            next += 1;
            is_object |= needed[i] & BEST != 0;
            let [x, y, z] = coordinates(i);
            let range = |v: usize| v.saturating_sub(1)..(v + 2).min(CELLS);
            for z in range(z) {
                for y in range(y) {
                    for x in range(x) {
                        let j = (z * CELLS + y) * CELLS + x;
                        if needed[j] > 0 && !visited[j] {
                            visited[j] = true;
                            group.push(j as u32);
                        }
                    }
                }
            }
        }
        for &i in &group {
            needed[i as usize] = if is_object { needed[i as usize] & !BEST } else { 0 };
        }
    }
    workspace.recycle(visited);
    workspace.recycle(group);
}
