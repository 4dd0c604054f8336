//! What a frame needs of memory, so that a host can refuse it before it is taken.
//!
//! On one thread and without the pictures that the host hands in, a frame needs at most
//!
//! `6 P + max(16 MiB, 9000 B, level P + point S + 640 V)` bytes
//!
//! with P the pixels of all views, B the blocks of the hull's grid that its surface may pass, S the pixels inside the
//! silhouettes and V the vertices of the final mesh. `level`
//! is 3 for detection at full resolution and 3/4 at half, where S counts a quarter too; `point` is 140, or 200 where
//! clouds are thinned and cleaned of conflicts (§5); both are 0 for the hull alone. The factors are measured.

use crate::{
    error::{Error, Result},
    hull::VisualHull,
    params::{Method, Params},
    point_cloud::Mesh,
    rig::Rig,
    view::View,
};

/// Colours, luma and silhouette.
const PER_PIXEL: u64 = 6;
/// The search for the hull.
const SEARCH: u64 = 16 << 20;
/// A block of the hull's grid: its nodes' values, those that marching cubes keeps, its part of the mesh.
const PER_BLOCK: u64 = 9000;
/// Grids and samples of the Poisson solver, the mesh, its colours.
const PER_VERTEX: f64 = 640.0;

/// Bytes that every frame of a rig needs at least.
pub fn smallest(rig: &Rig) -> u64 {
    let pixels = rig.cameras().iter().map(|c| u64::from(c.width) * u64::from(c.height)).sum::<u64>();
    PER_PIXEL * pixels + SEARCH
}

/// What a frame needs up to its hull's mesh, in bytes, once the hull is known.
fn needed_for_hull(views: &[View], hull: &VisualHull) -> u64 {
    PER_PIXEL * pixels(views) + SEARCH.max(PER_BLOCK * hull.field().0.blocks.len() as u64)
}

fn pixels(views: &[View]) -> u64 {
    views.iter().map(|v| v.luma.len() as u64).sum()
}

/// What a frame needs at most, in bytes, once its silhouettes, its hull and the hull's mesh are known.
pub fn needed(views: &[View], hull: &VisualHull, hull_mesh: &Mesh, params: &Params) -> u64 {
    let inside = |v: &View| match &v.silhouette {
        Some(silhouette) => silhouette.distances().iter().filter(|&&d| d > 0).count(),
        None => v.luma.len(),
    };
    let finer = params.hull.voxel_pixels / params.meshing.voxel_pixels;
    let mut later = PER_VERTEX * hull_mesh.positions.len() as f64 * f64::from((finer * finer).max(1.0));
    if params.method == Method::Pcmvs {
        let share = if params.detection.octave > 0 { 0.25 } else { 1.0 };
        let cleaned = params.merging.downsample.is_some() || params.merging.conflicts.is_some();
        let silhouettes = views.iter().map(inside).sum::<usize>() as f64;
        later += share * (3.0 * pixels(views) as f64 + if cleaned { 200.0 } else { 140.0 } * silhouettes);
    }
    needed_for_hull(views, hull).max(PER_PIXEL * pixels(views) + later as u64)
}

/// Refuses a frame whose hull's mesh needs more than `limit` bytes, before that mesh is made.
///
/// # Errors
/// [`Error::OutOfMemory`].
pub fn check_hull(views: &[View], hull: &VisualHull, limit: Option<u64>) -> Result<()> {
    within(|| needed_for_hull(views, hull), limit)
}

/// Refuses a frame that needs more than `limit` bytes, once its silhouettes, its hull and the hull's mesh are known.
///
/// # Errors
/// [`Error::OutOfMemory`].
pub fn check(views: &[View], hull: &VisualHull, hull_mesh: &Mesh, params: &Params, limit: Option<u64>) -> Result<()> {
    within(|| needed(views, hull, hull_mesh, params), limit)
}

/// Refuses any frame of a rig whose views alone need more than `limit` bytes.
///
/// # Errors
/// [`Error::OutOfMemory`].
pub fn check_rig(rig: &Rig, limit: Option<u64>) -> Result<()> {
    within(|| smallest(rig), limit)
}

fn within(needed: impl FnOnce() -> u64, limit: Option<u64>) -> Result<()> {
    let Some(limit) = limit else { return Ok(()) };
    let needed = needed();
    if needed <= limit { Ok(()) } else { Err(Error::OutOfMemory { needed, limit }) }
}
