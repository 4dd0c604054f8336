//! Surfaces of sampled fields: what the visual hull (§0) and meshing (§6) share.

mod cases;
mod components;
mod envelope;
mod marching_cubes;
pub(crate) mod neighbourhood;

pub use components::drop_small_components;
pub use envelope::{Envelope, SLOPE};
pub use marching_cubes::{Unstored, marching_cubes};
