//! Visual hull (§0; Laurentini, The Visual Hull Concept for Silhouette-Based Image Understanding, PAMI 1994): the
//! largest volume that is consistent with all silhouettes.
//!
//! The hull is the set in which [`VisualHull::signed_distance`] is positive. That function is the minimum, over the
//! views that see a point, of the distance from the point's projection to the silhouette's contour. It is as accurate
//! as the contours. A sparse grid of its values around the surface is used to find the surface and to mesh it.

mod agreement;
mod block_distances;
mod blocks;
mod carve;
mod carver;
mod coarser;
mod comparison;
mod exchanged;
mod judge;
pub(crate) mod memory;
mod point_distance;
mod ray;
mod search;
mod space;
mod support;
mod visual_hull;
mod walk;

pub use agreement::{Agreement, AgreementParams, Carving, Completed, apart, carve_agreeing, completed, contradicting};
pub use carve::HullParams;
pub use comparison::{Comparison, compare};
pub use exchanged::exchanged;
pub use visual_hull::VisualHull;
pub(crate) use walk::Walk;
