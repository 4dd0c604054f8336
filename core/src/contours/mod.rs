//! Points that are derived from the silhouettes alone (§4.4): frontier points on contour generators, and implicit
//! points on parts of the hull that no camera sees.

mod frontier;
mod implicit;

pub use frontier::{Certainty, FrontierParams, frontier};
pub use implicit::{ImplicitParams, implicit};

use crate::{
    context::Context,
    error::Result,
    executor::Executor,
    point_cloud::{Mesh, PointCloud},
    progress,
    stage::Stage,
};

/// The points that this stage finds. Their weights are set later ([`crate::mesh::weigh`]).
#[derive(Debug, Clone, Default)]
pub struct Contours {
    /// Frontier points of all views, in the order of the views.
    pub frontier: PointCloud,
    /// Implicit points.
    pub implicit: PointCloud,
}

/// Finds frontier and implicit points. A kind without parameters is skipped. `hull_mesh` is the hull's own mesh.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn contours(
    context: Context,
    hull_mesh: &Mesh,
    frontier_params: Option<&FrontierParams>,
    implicit_params: Option<&ImplicitParams>,
    executor: &dyn Executor,
) -> Result<Contours> {
    let Context { views, hull, progress, .. } = context;
    let count = views.len() as u32;
    let mut contours = Contours::default();
    if let Some(params) = frontier_params {
        let found = executor.map(views.len(), |i| {
            progress::step(progress, Stage::Contours, i as u32, 2 * count)?;
            Ok(frontier(&views[i], hull, params))
        });
        for cloud in found {
            contours.frontier.extend(cloud?);
        }
    }
    if let Some(params) = implicit_params {
        let tick = |i| progress::step(progress, Stage::Contours, count + i, 2 * count);
        contours.implicit = implicit(hull_mesh, views, params, tick)?;
    }
    Ok(contours)
}
