//! The signed distance along a walk through space.

use super::{carver::Carver, visual_hull::VisualHull};
use glam::Vec3;

/// The signed distance at the places of a walk. A view that sees one place clearly outside mostly does so for the next
/// as well, and one that does is enough.
pub(crate) struct Walk<'h> {
    hull: &'h VisualHull,
    without: u16,
    excluding: Option<&'h Carver>,
}

impl<'h> Walk<'h> {
    /// Over all views but one.
    pub(crate) fn new(hull: &'h VisualHull, without: u16) -> Self {
        Self { hull, without, excluding: None }
    }

    /// [`VisualHull::signed_distance_without`]; where that is below `-clear`, a larger value that is below too.
    #[inline]
    pub(crate) fn signed_distance(&mut self, p: Vec3, clear: f32) -> f32 {
        if let Some(d) = self.excluding.and_then(|carver| carver.distance(p)).filter(|&d| d < -clear) {
            return d;
        }
        let (d, from) = self.hull.nearest_contour(p, self.without);
        self.excluding = from;
        d
    }
}
