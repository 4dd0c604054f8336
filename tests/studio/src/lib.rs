//! A synthetic capture dome with exact ground truth.

pub mod backdrop;
pub mod capture;
pub mod faults;
mod figure;
pub mod material;
pub mod noise;
pub mod part;
pub mod polygonise;
pub mod render;
pub mod ring;
pub mod scene;
pub mod write;

pub use capture::{Capture, Frame, Picture};
pub use faults::Faults;
pub use ring::{Ring, dome, pairs};
pub use scene::{Scene, Subject};
