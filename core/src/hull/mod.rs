//! Visual hull (§0): the space that every silhouette allows.
//!
//! The hull is the set where [`VisualHull::signed_distance`] is positive. That function takes, over the views that see a
//! point, the smallest distance from the point's projection to the silhouette's contour. It is exact to the contour's own
//! precision. A sparse grid of its values around the surface serves to find the surface and to mesh it.

mod carve;
mod carver;
mod judge;
mod ray;
mod search;
mod visual_hull;
mod walk;

pub use carve::HullParams;
pub use visual_hull::VisualHull;
pub(crate) use walk::Walk;
