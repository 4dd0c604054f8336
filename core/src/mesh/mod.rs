//! Meshing (§6): points to a closed manifold mesh inside the visual hull.

mod cases;
mod components;
mod marching_cubes;
mod neighbourhood;
mod poisson;
mod space_constraint;

use glam::Vec3;

use crate::error::{Error, Result};
use crate::params::MeshingParams;
use crate::point_cloud::{Mesh, Point};
use crate::progress::{self, Progress, Stage};
use crate::workspace::Workspace;
pub use components::drop_small_components;
pub use marching_cubes::marching_cubes;

/// What encloses the object: the visual hull.
pub trait Envelope {
    /// Lower and upper corner of its bounding box.
    fn bounds(&self) -> (Vec3, Vec3);
    /// Signed distance in scene units, positive inside. It may change by at most 1.3 per unit of length.
    fn signed_distance(&self, p: Vec3) -> f32;
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
const MOST_NODES: f32 = 4096.0;

/// Reports the meshing's progress.
struct Steps<'a> {
    progress: &'a dyn Progress,
    done: u32,
    total: u32,
}

impl Steps<'_> {
    fn step(&mut self) -> Result<()> {
        self.done = (self.done + 1).min(self.total);
        progress::step(self.progress, Stage::Mesh, self.done, self.total)
    }
}

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
    if !(voxel > 0.0 && (high - low).min_element() >= 0.0 && (high - low).max_element() < MOST_NODES * voxel) {
        return Err(Error::NoSurface);
    }
    let solves = 1 + u32::from(params.space_constraint && !params.envelope);
    let total = solves * (poisson::steps(low, high, voxel) + 2) + 1;
    let mut steps = Steps { progress, done: 0, total };
    let mut surface = |points: &[Point], constraint: Option<&dyn Envelope>| -> Result<Mesh> {
        let solution = poisson::solve(points, (low, high), voxel, params.screening, constraint, workspace, &mut steps)?;
        let mut mesh = solution.surface(workspace);
        steps.step()?;
        poisson::smooth_normals(&mut mesh, workspace);
        steps.step()?;
        Ok(mesh)
    };
    let mut mesh = if !params.space_constraint {
        surface(points, None)?
    } else if params.envelope {
        surface(points, Some(envelope))?
    } else {
        let first = surface(points, None)?;
        surface(&space_constraint::rectified(&first, envelope, voxel), None)?
    };
    let components_dropped = drop_small_components(&mut mesh, params.smallest_component, workspace);
    progress::step(progress, Stage::Mesh, total, total)?;
    if mesh.triangles.is_empty() {
        return Err(Error::NoSurface);
    }
    Ok(Meshed { mesh, components_dropped })
}
