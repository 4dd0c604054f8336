//! Meshing (§6): points to a closed manifold mesh inside the visual hull.

mod poisson;
mod rectify;
mod steps;
mod weight;

pub use weight::{WeightParams, weigh};

use crate::{
    error::{Error, Result},
    point_cloud::{Mesh, Point},
    progress::{self, Progress},
    stage::Stage,
    surface::{Envelope, drop_small_components},
    workspace::Workspace,
};
use steps::Steps;

/// Meshing (§6).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MeshingParams {
    /// Distance of the grid's nodes in pixels of footprint at the object.
    pub voxel_pixels: f32,
    /// Eq. 3 (§6.1). Without it all points weigh the same.
    pub weights: Option<WeightParams>,
    /// Weight of the screening term, which holds the surface at the points rather than at their normals alone. Without it
    /// the solver is the unscreened one of the paper.
    pub screening: Option<f32>,
    /// §6.2. Without it the surface may leave the hull.
    pub space_constraint: Option<SpaceConstraint>,
    /// Components with less than this share of the largest one's volume are dropped.
    pub smallest_component: f32,
}

/// How the mesh is kept inside the hull (§6.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum SpaceConstraint {
    /// χ is held at zero outside the hull while it is solved for (Kazhdan, Chuang, Rusinkiewicz, Hoppe: Poisson Surface
    /// Reconstruction with Envelope Constraints, SGP 2020).
    Envelope,
    /// The paper's way: vertices outside move onto the hull, and the solver runs again on the rectified points.
    Rectify,
}

/// The mesh of §6.
#[derive(Debug, Clone)]
pub struct Meshed {
    /// Closed and manifold, with normals, not yet coloured.
    pub mesh: Mesh,
    /// Stray components and cavities that were dropped.
    pub components_dropped: u32,
}

/// Most nodes along the longest side of the bounds.
const MAX_NODES: f32 = 4096.0;

/// Meshes oriented points (§6) with nodes `voxel` scene units apart. The result depends on the points only, not on
/// their order.
///
/// # Errors
/// [`Error::NoSurface`] if the points bound nothing or the envelope's bounds are empty or over 4096 voxels long,
/// [`Error::Cancelled`].
pub fn mesh(
    points: &[Point],
    envelope: &dyn Envelope,
    voxel: f32,
    params: &MeshingParams,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<Meshed> {
    let (low, high) = envelope.bounds();
    // Written so that NaN fails too.
    if !(voxel > 0.0 && (high - low).min_element() >= 0.0 && (high - low).max_element() < MAX_NODES * voxel) {
        return Err(Error::NoSurface);
    }
    let solves = if params.space_constraint == Some(SpaceConstraint::Rectify) { 2 } else { 1 };
    let total = solves * (poisson::steps(low, high, voxel) + 2) + 1;
    let mut steps = Steps { progress, done: 0, total };
    let screening = params.screening.unwrap_or(0.0);
    let mut surface = |points: &[Point], constraint: Option<&dyn Envelope>| -> Result<Mesh> {
        let solution = poisson::solve(points, (low, high), voxel, screening, constraint, workspace, &mut steps)?;
        let mut mesh = solution.surface(workspace);
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
            surface(&rectify::rectified(&first, envelope, voxel), None)?
        }
    };
    let components_dropped = drop_small_components(&mut mesh, params.smallest_component, workspace);
    progress::step(progress, Stage::Mesh, total, total)?;
    if mesh.triangles.is_empty() {
        return Err(Error::NoSurface);
    }
    Ok(Meshed { mesh, components_dropped })
}
