//! The signed distance at a sequence of nearby points.

use super::{carver::Carver, visual_hull::VisualHull};
use glam::Vec3;

/// Evaluates the signed distance at successive points of a path. A view that excludes one point clearly will mostly
/// exclude the next one too, and one such view is sufficient.
pub(crate) struct Walk<'h> {
    hull: &'h VisualHull,
    /// Station of the views that are left out.
    without: u16,
    excluding: Option<&'h Carver>,
}

impl<'h> Walk<'h> {
    /// Over all views except one, and except those at the same place as it.
    pub(crate) fn new(hull: &'h VisualHull, without: u16) -> Self {
        Self { hull, without: hull.station(without), excluding: None }
    }

    /// [`VisualHull::signed_distance_without`]. If that is less than `-clear`, the result may be a larger value that is
    /// also less than `-clear`.
    #[inline]
    pub(crate) fn signed_distance(&mut self, p: Vec3, clear: f32) -> f32 {
        if let Some(d) = self.excluding.and_then(|carver| carver.distance(p)).filter(|&d| d < -clear) {
            return d;
        }
        let (d, from) = self.hull.nearest_contour(p, self.without, f32::INFINITY);
        self.excluding = from;
        d
    }
}
