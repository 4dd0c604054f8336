//! A synthetic capture dome with exact ground truth.
//!
//! A [`Subject`] at a time is a [`Solid`]: a signed distance function with colours. A [`Ring`] gives cameras,
//! [`Capture::new`] records pictures and masks with the given [`Faults`], and [`Capture::write`] writes them as a scene
//! folder. Because the solid is a function, [`score`] measures the errors of a reconstruction exactly. All results are the
//! same on every machine, byte for byte.

pub mod backdrop;
mod blur;
pub mod capture;
pub mod contour;
pub mod faults;
mod figure;
pub mod look;
pub mod masks;
pub mod material;
pub mod mesh;
pub mod mosaic;
pub mod noise;
pub mod part;
pub mod picture;
pub mod polygonise;
pub mod render;
pub mod ring;
mod rotation;
pub mod score;
pub mod solid;
pub mod subject;
pub mod topology;
pub mod write;

pub use capture::{Capture, CapturedFrame};
pub use faults::Faults;
pub use masks::Spots;
pub use mesh::TriangleMesh;
pub use picture::Picture;
pub use ring::{Ring, dome, pairs};
pub use solid::Solid;
pub use subject::Subject;
