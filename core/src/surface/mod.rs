//! Surfaces of sampled fields. The visual hull (§0) and meshing (§6) share this module.

pub(crate) mod bspline;
mod cases;
mod components;
mod envelope;
mod marching_cubes;
pub(crate) mod neighbourhood;
mod vertex_neighbours;

pub use components::drop_small_components;
pub use envelope::{Envelope, SLOPE};
pub use marching_cubes::{Unstored, marching_cubes};
pub(crate) use marching_cubes::{complete_normals, without_normals};
pub(crate) use vertex_neighbours::VertexNeighbours;
