//! The volume that encloses the object.

use glam::Vec3;

/// The volume that a mesh must stay inside (§6.2): the visual hull, or an analytic shape in tests.
pub trait Envelope: Sync {
    /// Lower and upper corner of its bounding box, in scene units and relative to the rig's origin.
    fn bounds(&self) -> (Vec3, Vec3);
    /// Signed distance in scene units, positive inside. Its slope is at most [`SLOPE`].
    fn signed_distance(&self, p: Vec3) -> f32;
    /// [`Self::signed_distance`]. If that is less than `-clear`, the result may be a larger value that is also less than
    /// `-clear`, where that takes less time.
    fn distance_until(&self, p: Vec3, clear: f32) -> f32 {
        let _ = clear;
        self.signed_distance(p)
    }
}

/// Lipschitz bound of a hull's signed distance: the largest change per unit of length.
///
/// The distance is the distance to a contour in pixels, times the footprint at the point. Away from the optical axis a
/// pixel covers less space than the footprint, so that the product changes faster than the true distance.
pub const SLOPE: f32 = 1.3;
