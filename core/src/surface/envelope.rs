//! What encloses the object.

use glam::Vec3;

/// The volume that a mesh must stay inside: the visual hull in production, an analytic shape in tests.
pub trait Envelope {
    /// Lower and upper corner of its bounding box, relative to the rig's origin, in scene units.
    fn bounds(&self) -> (Vec3, Vec3);
    /// Signed distance in scene units, positive inside. Its slope is at most [`SLOPE`].
    fn signed_distance(&self, p: Vec3) -> f32;
}

/// Largest change of a hull's signed distance per unit of length.
///
/// The distance is the pixel distance to a contour times the pixel's footprint at the point. Off the optical axis a pixel
/// covers less of space than the footprint says, so that the product changes faster than the true distance does.
pub const SLOPE: f32 = 1.3;
