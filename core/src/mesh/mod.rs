//! Meshing (§6).

mod cases;
mod marching_cubes;
mod neighbourhood;

pub use marching_cubes::marching_cubes;
