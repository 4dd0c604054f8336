//! Meshing (§6): reconstructs a closed manifold mesh inside the visual hull from oriented points.
//!
//! `weight` implements eq. 3 (§6.1), `poisson` the surface reconstruction (§6.1), and `rectify` the space constraint as
//! in the paper (§6.2).

mod poisson;
mod rectify;
mod steps;
mod weight;

pub use weight::{WeightParams, weigh};

use crate::{
    error::{Error, Result},
    executor::Executor,
    point_cloud::{Mesh, Point},
    progress::{self, Progress},
    stage::Stage,
    surface::{Envelope, drop_small_components},
    workspace::Workspace,
};
use alloc::borrow::Cow;
use glam::Vec3;
use steps::Steps;

/// Parameters of meshing (§6).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MeshingParams {
    /// Spacing of the grid's nodes, in pixels of footprint at the object.
    pub voxel_pixels: f32,
    /// Weights of eq. 3 (§6.1). Without them all points have the same weight.
    pub weights: Option<WeightParams>,
    /// Weight of the screening term, which pulls the surface to the positions of the points (Kazhdan & Hoppe, Screened
    /// Poisson Surface Reconstruction, 2013). Without it the solver is unscreened, as in the paper.
    pub screening: Option<f32>,
    /// Smooths the surface where its points are imprecise. This is the standard deviation of points, in pixels of
    /// footprint, at which half of the finest detail is removed. Around points that are less precise more of it is
    /// removed, around more precise ones less. Wider noise goes from the mesh, as far as the points' precision explains it.
    /// Without it all detail is kept. Not in the paper.
    pub calm: Option<f32>,
    /// How often the vertices are moved along the surface, halfway to the mean of their neighbours each time. It spreads them
    /// evenly, so that their colours hold more of the pictures' detail and flicker less. Not in the paper.
    pub even_passes: u32,
    /// Space constraint (§6.2). Without it the surface may leave the hull.
    pub space_constraint: Option<SpaceConstraint>,
    /// Components with a volume of less than this fraction of the largest one's are dropped.
    pub smallest_component: f32,
}

/// How the mesh is kept inside the hull (§6.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum SpaceConstraint {
    /// The indicator function χ is held at zero outside the hull while it is solved (Kazhdan, Chuang, Rusinkiewicz &
    /// Hoppe, Poisson Surface Reconstruction with Envelope Constraints, SGP 2020).
    Envelope,
    /// As in the paper: vertices outside move onto the hull, and the solver runs again on the rectified points.
    Rectify,
}

/// The result of meshing.
#[derive(Debug, Clone)]
pub struct Meshed {
    /// A closed manifold mesh with normals and without colours.
    pub mesh: Mesh,
    /// Number of stray components and cavities that were dropped.
    pub components_dropped: u32,
}

/// Number of blocks in the bounding box of the grid on which points within bounds of this size are meshed.
pub(crate) fn grid_blocks(size: Vec3, voxel: f32) -> u64 {
    if fits(size, voxel) { poisson::blocks(size, voxel) } else { 0 }
}

/// Whether bounds of this size are not empty, and not too long for the solver's grid.
fn fits(size: Vec3, voxel: f32) -> bool {
    // Written so that NaN fails as well.
    voxel > 0.0 && size.min_element() >= 0.0 && size.max_element() < MAX_NODES * voxel
}

/// Largest number of voxels along the longest side of the bounds.
const MAX_NODES: f32 = 4096.0;

/// Meshes oriented points (§6) on a grid whose nodes are `voxel` scene units apart. The result does not depend on the
/// order of the points. Points that are owned are freed as early as possible, borrowed ones are not copied.
///
/// # Errors
/// [`Error::NoSurface`] if the points do not bound a surface, or if the envelope's bounds are empty or 4096 voxels long
/// or longer; [`Error::Cancelled`].
pub fn mesh(
    points: Cow<[Point]>,
    envelope: &dyn Envelope,
    voxel: f32,
    params: &MeshingParams,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Meshed> {
    let (low, high) = envelope.bounds();
    if !fits(high - low, voxel) {
        return Err(Error::NoSurface);
    }
    let solves = if params.space_constraint == Some(SpaceConstraint::Rectify) { 2 } else { 1 };
    // A second solve takes the first surface's vertices as points. Their number is not known yet, but is about the same.
    let total = solves * (poisson::steps(low, high, voxel, points.len()) + 2) + 1;
    let mut steps = Steps { progress, done: 0, total };
    let screening = params.screening.unwrap_or(0.0);
    let mut surface = |points: Cow<[Point]>, constraint: Option<&dyn Envelope>| -> Result<Mesh> {
        let pull = poisson::Pull { screening, calm: params.calm };
        let solution = poisson::solve(points, (low, high), voxel, pull, constraint, workspace, executor, &mut steps)?;
        let mut mesh = solution.surface(workspace, executor);
        steps.step()?;
        poisson::smooth_normals(&mut mesh, workspace);
        steps.step()?;
        Ok(mesh)
    };
    let mut mesh = match params.space_constraint {
        None => surface(points, None)?,
        Some(SpaceConstraint::Envelope) => surface(points, Some(envelope))?,
        Some(SpaceConstraint::Rectify) => {
            let first = surface(points, None)?;
            // Borrowed, because a workspace grows with every vector that does not come from it.
            surface(Cow::Borrowed(&rectify::rectified(&first, envelope, voxel)), None)?
        }
    };
    let components_dropped = drop_small_components(&mut mesh, params.smallest_component, workspace);
    poisson::even(&mut mesh, params.even_passes, workspace, executor);
    progress::step(progress, Stage::Mesh, total, total)?;
    if mesh.triangles.is_empty() {
        return Err(Error::NoSurface);
    }
    Ok(Meshed { mesh, components_dropped })
}

#[cfg(test)]
mod tests;
