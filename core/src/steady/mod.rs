//! Steadiness in time: a mesh takes the mean with the meshes of the frames before and after it, along surfaces that move with
//! the subject. The paper has no such step and names this as its weakness (§7.8).
//!
//! Every frame is reconstructed by itself, so that the errors of stereo, of contours and of colours differ from frame to
//! frame: surfaces jitter and colours flicker. Here the mesh is laid onto the mesh of each neighbouring frame by rigid motions
//! of many small parts (`motion`). These absorb how the subject moves. What is left is how the two meshes differ in details
//! that are smaller than a part, and each vertex takes the mean of that (`mean`). Where a neighbour has no surface near, or one
//! of another colour, it does not count. A part that moves less than the noise is taken to be at rest.
//!
//! The result depends on the meshes alone, and not on the order in which frames are made. Triangles stay as they are, so that
//! a closed manifold remains one.

mod mean;
mod motion;
mod moves;
mod nodes;
mod params;
mod search;
mod system;
mod target;

use crate::{
    error::Result,
    executor::Executor,
    point_cloud::Mesh,
    progress::{self, Progress},
    stage::Stage,
};
use moves::Moves;
use nodes::Nodes;
use target::Target;

pub use mean::MeanParams;
pub use params::{LevelParams, MotionParams};

/// Parameters of [`steady`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SteadyParams {
    /// How the motion between two frames is found.
    pub motion: MotionParams,
    /// How a frame and its neighbours are averaged.
    pub mean: MeanParams,
}

impl SteadyParams {
    /// The measured values.
    pub const DEFAULT: Self = Self { motion: MotionParams::DEFAULT, mean: MeanParams::DEFAULT };
}

/// Averages a coloured mesh with the meshes of neighbouring frames, such as the one before and the one after it. All are
/// relative to the same origin. `footprint` is the size of a pixel at the object, in scene units
/// ([`crate::hull::VisualHull::footprint`]).
///
/// # Errors
/// [`crate::Error::Cancelled`].
///
/// # Panics
/// If a mesh has no colours.
pub fn steady(
    mesh: &mut Mesh,
    neighbours: &[&Mesh],
    footprint: f32,
    params: &SteadyParams,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<()> {
    let total = neighbours.len() as u32 + 1;
    progress::step(progress, Stage::Steady, 0, total)?;
    let per_unit = 1.0 / footprint;
    let own = Target::new(mesh, per_unit, executor);
    let nodes = Nodes::new(&own, params.motion.node_pixels);
    let mut means = mean::Means::new(&own);
    for (done, neighbour) in neighbours.iter().enumerate() {
        let target = Target::new(neighbour, per_unit, executor);
        let motions = motion::motions(&own, &nodes, &target, &params.motion, executor);
        means.add(&own, &Moves { nodes: &nodes, motions: &motions }, &target, &params.mean, executor);
        progress::step(progress, Stage::Steady, done as u32 + 1, total)?;
    }
    drop(own);
    means.apply(mesh, footprint);
    Ok(())
}

#[cfg(test)]
mod tests;
