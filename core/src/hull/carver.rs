//! A view with a silhouette, which carves the hull (§0).

use crate::{
    camera::Pinhole,
    silhouette::{Silhouette, stored},
    view::View,
};
use alloc::{sync::Arc, vec::Vec};
use glam::Vec3;

/// Signed distances are at most this many voxels. Beyond that only the sign matters.
pub(super) const FAR: f32 = 64.0;

/// Width of the margin along a picture's edge in which a silhouette is not believed, in pixels. Keyers and filters see only
/// one side of a contour there.
pub(super) const EDGE: f32 = 4.0;

/// A view with a silhouette.
#[derive(Clone)]
pub(super) struct Carver {
    pub(super) camera: Pinhole,
    pub(super) silhouette: Arc<Silhouette>,
    /// Index of the view in the rig's order.
    pub(super) index: u16,
    /// The smallest index of a view at the same place.
    pub(super) station: u16,
}

/// Cameras closer to each other than this share of their distance from the rig's origin stand at the same place: a ray
/// of one runs along the contour of the other.
const SAME_PLACE: f32 = 1e-3;

/// The views that carve, with their stations.
pub(super) fn carvers(views: &[View]) -> Vec<Carver> {
    let mut carvers: Vec<Carver> = Vec::new();
    for view in views {
        let Some(mut carver) = Carver::new(view) else { continue };
        let near = |a: &Carver| {
            let reach = SAME_PLACE * SAME_PLACE * carver.camera.centre.length_squared();
            (a.camera.centre - carver.camera.centre).length_squared() < reach
        };
        if let Some(first) = carvers.iter().find(|a| near(a)) {
            carver.station = first.station;
        }
        carvers.push(carver);
    }
    carvers
}

/// A silhouette's distances at four neighbouring pixels, the upper two in one word and the lower two in another, the left one
/// in the lower half. In this form vectors hold those of several views or points.
pub(super) type Square = [u32; 2];

/// The square whose upper left pixel has the index `first` in a silhouette of the given width.
#[inline(always)]
pub(super) fn square(silhouette: &Silhouette, width: usize, first: u32) -> Square {
    let d = &silhouette.distances()[first as usize..][..width + 2];
    [[d[0], d[1]], [d[width], d[width + 1]]].map(|[a, b]| u32::from(a as u16) | u32::from(b as u16) << 16)
}

/// [`Silhouette::sample`] in a square, at a fraction of a pixel from its upper left pixel. The second result is whether all of
/// the square's distances are known.
#[inline(always)]
pub(super) fn interpolate([upper, lower]: Square, x: f32, y: f32) -> (f32, bool) {
    let ([a, b], [c, d]) = (halves(upper), halves(lower));
    let unknown = i32::from(Silhouette::UNKNOWN);
    let is_known = (a != unknown) & (b != unknown) & (c != unknown) & (d != unknown);
    let (a, b, c, d) = (a as f32, b as f32, c as f32, d as f32);
    let (top, bottom) = (a + (b - a) * x, c + (d - c) * x);
    (stored::pixels(top + (bottom - top) * y), is_known)
}

/// The two signed halves of a word, the lower one first.
#[inline(always)]
fn halves(word: u32) -> [i32; 2] {
    [(word << 16) as i32 >> 16, word as i32 >> 16]
}

impl Carver {
    /// `None` if the view has no silhouette or is left out.
    fn new(view: &View) -> Option<Self> {
        if !view.is_used() {
            return None;
        }
        let silhouette = Arc::clone(view.silhouette.as_ref()?);
        Some(Self { camera: view.camera, silhouette, index: view.index, station: view.index })
    }

    /// Distance from a point's projection to the contour, scaled to scene units at the point's depth; positive inside.
    /// `None` if the view does not see the point.
    #[inline]
    pub(super) fn distance(&self, p: Vec3) -> Option<f32> {
        let q = self.camera.project(p);
        self.sample(q).map(|d| d * self.camera.footprint(q.z))
    }

    /// Distance from a point's projection to the contour in pixels; positive inside. `None` if the view does not see the
    /// point.
    #[inline]
    pub(super) fn pixels(&self, p: Vec3) -> Option<f32> {
        self.sample(self.camera.project(p))
    }

    /// The last column and the last row in which the silhouette is believed.
    #[inline]
    pub(super) fn believed(&self) -> (f32, f32) {
        (self.camera.width as f32 - 1.0 - EDGE, self.camera.height as f32 - 1.0 - EDGE)
    }

    /// The silhouette's distance at a projected point.
    #[inline]
    fn sample(&self, q: Vec3) -> Option<f32> {
        let (right, bottom) = self.believed();
        let is_within = q.z > 0.0 && q.x >= EDGE && q.y >= EDGE && q.x <= right && q.y <= bottom;
        if is_within { self.silhouette.sample(q.x, q.y) } else { None }
    }
}
