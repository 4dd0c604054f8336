//! Fewer triangles: edges collapse in the order in which that shows least, until a number of triangles is reached.
//!
//! An edge becomes a vertex at the place of least quadric error (Garland & Heckbert, Surface simplification using quadric
//! error metrics, 1997), among those that keep the volume. Colours count in the error (Hoppe, New quadric metric for
//! simplifying meshes with appearance attributes, 1999). A collapse happens only if the mesh stays a closed manifold of the
//! same genus, no triangle turns over or becomes a sliver, and every vertex of the original stays near the surface.
//!
//! `topology` holds the triangles and collapses an edge, `quadric` is the error, `deviation` its bound, `queue` the order of
//! the edges, and `collapse` decides on one of them.

mod collapse;
mod deviation;
mod params;
mod quadric;
mod queue;
mod topology;

use alloc::{vec, vec::Vec};
use glam::{DVec3, Vec3};

use crate::{
    error::Result,
    point_cloud::Mesh,
    progress::{self, Progress},
    stage::Stage,
};
use collapse::Collapsing;
pub use params::SimplifyParams;
use queue::Queue;
use topology::NONE;

/// Number of collapses between two reports of progress.
const REPORT: u32 = 1024;

/// A mesh of at most `faces` triangles that looks like `mesh`: closed and manifold, with as many parts and holes, the same
/// volume, new normals, and colours if `mesh` has them. Vertices keep their order, and so do triangles.
///
/// The result has more triangles than asked for if no more edges can collapse under the conditions: compare its number with
/// `faces`. A mesh that has no more than `faces` triangles is returned as it is. Places at which `mesh` is open or not
/// manifold stay as they are.
///
/// Progress is reported as [`Stage::Form`], without its start and end.
///
/// # Errors
/// [`crate::Error::Cancelled`].
///
/// # Panics
/// If a triangle names a vertex that does not exist.
pub fn simplify(mesh: &Mesh, params: &SimplifyParams, progress: &dyn Progress) -> Result<Mesh> {
    let before = mesh.triangles.len() as u32;
    if before <= params.faces {
        return Ok(mesh.clone());
    }
    let total = (before - params.faces).div_ceil(2);
    progress::step(progress, Stage::Form, 0, total)?;
    let mut work = Collapsing::new(mesh, params);
    let mut queue = Queue::new(mesh.triangles.len() * 3);
    let mut collapsed = 0;
    // Edges that could not collapse are tried again as long as others have.
    loop {
        let earlier = collapsed;
        queue.fill(work.topology.edges().filter_map(|edge| Some((edge, work.best(edge)?.cost))));
        while work.topology.triangles() > params.faces {
            let Some(edge) = queue.pop() else { break };
            let gone = work.topology.sides(edge);
            let Some(vertex) = work.try_collapse(edge) else { continue };
            gone.into_iter().for_each(|edge| queue.remove(edge));
            for h in work.topology.fan(vertex) {
                let edge = work.topology.edge(h);
                let best = if work.topology.is_movable(edge) { work.best(edge) } else { None };
                match best {
                    Some(best) => queue.set(edge, best.cost),
                    None => queue.remove(edge),
                }
            }
            collapsed += 1;
            if collapsed % REPORT == 0 {
                progress::step(progress, Stage::Form, collapsed, total)?;
            }
        }
        if work.topology.triangles() <= params.faces || collapsed == earlier {
            break;
        }
    }
    progress::step(progress, Stage::Form, total, total)?;
    Ok(collect(mesh, work))
}

/// The mesh of what is left.
fn collect(mesh: &Mesh, work: Collapsing) -> Mesh {
    let names = work.topology.names();
    let mut out = Mesh::default();
    for v in (0..names.len() as u32).filter(|&v| names[v as usize] != NONE) {
        out.positions.push(work.positions[v as usize]);
        if let Some(&own) = mesh.colours.get(v as usize) {
            out.colours.push(work.colour(v).unwrap_or(own));
        }
    }
    out.triangles = work.topology.into_triangles();
    for triangle in &mut out.triangles {
        *triangle = triangle.map(|v| names[v as usize]);
    }
    out.normals = normals(&out);
    out
}

/// The mean of the triangles' normals around each vertex, weighted by area.
fn normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for &triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].as_dvec3());
        let cross = (b - a).cross(c - a);
        triangle.iter().for_each(|&v| sums[v as usize] += cross);
    }
    sums.into_iter().map(|sum| sum.try_normalize().unwrap_or(DVec3::Z).as_vec3()).collect()
}
