//! §4.4: implicit points, on parts of the hull that no camera sees.

use crate::{
    error::Result,
    point_cloud::{Mesh, Point, PointCloud, Rank},
    raster::Raster,
    view::View,
};
use alloc::vec;

/// A point this close to a contour, in pixels, lies on it.
const CONTOUR_PIXELS: f32 = 1.5;
/// A point this far behind the hull's front, in pixels of footprint, is hidden by it.
const HIDDEN_FOOTPRINTS: f32 = 3.0;

/// The vertices of the hull's mesh that every view either does not see, because the hull hides them, or sees on its
/// contour. They only keep the model complete. `tick` is called with the number of each view.
pub fn implicit(hull: &Mesh, views: &[View], mut tick: impl FnMut(u32) -> Result<()>) -> Result<PointCloud> {
    let mut seen = vec![false; hull.positions.len()];
    let mut raster = Raster::default();
    for (i, view) in views.iter().enumerate() {
        tick(i as u32)?;
        raster.render(hull, &view.camera);
        for (seen, &p) in seen.iter_mut().zip(&hull.positions) {
            let pixel = view.camera.project(p);
            let tolerance = HIDDEN_FOOTPRINTS * view.camera.footprint(pixel.z);
            if *seen || !raster.sees(pixel, tolerance) {
                continue;
            }
            *seen = match &view.silhouette {
                Some(s) => s.sample(pixel.x, pixel.y).is_some_and(|d| d > CONTOUR_PIXELS),
                None => true,
            };
        }
    }
    let unseen = seen.iter().enumerate().filter(|&(_, &seen)| !seen);
    let points = unseen.map(|(i, _)| Point {
        position: hull.positions[i],
        normal: hull.normals[i],
        fidelity: 0.0,
        weight: 0.0,
        view: Point::NO_VIEW,
        rank: Rank::Implicit,
    });
    Ok(points.collect())
}
