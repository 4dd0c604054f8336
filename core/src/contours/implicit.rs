//! §4.4: implicit points, on parts of the hull that no camera sees.

use crate::{
    error::Result,
    point_cloud::{Mesh, Point, PointCloud, Rank},
    raster::Raster,
    view::View,
};
use alloc::vec;

/// Parameters of implicit points (§4.4).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ImplicitParams {
    /// A point lies on a contour if its distance to it is at most this, in pixels.
    pub contour_pixels: f32,
    /// A point is hidden if it lies more than this behind the hull's front, in pixels of footprint.
    pub hidden_pixels: f32,
}

/// The vertices of the hull's mesh that no view sees: in every view the vertex is either hidden by the hull or lies on
/// the contour. They only keep the model complete. `tick` is called with the index of each view.
pub fn implicit(
    hull: &Mesh,
    views: &[View],
    params: &ImplicitParams,
    mut tick: impl FnMut(u32) -> Result<()>,
) -> Result<PointCloud> {
    let mut seen = vec![false; hull.positions.len()];
    let mut raster = Raster::default();
    for (i, view) in views.iter().enumerate() {
        tick(i as u32)?;
        if !view.is_used() {
            continue;
        }
        raster.render(hull, &view.camera);
        for (seen, &p) in seen.iter_mut().zip(&hull.positions) {
            let pixel = view.camera.project(p);
            let tolerance = params.hidden_pixels * view.camera.footprint(pixel.z);
            if *seen || !raster.sees(pixel, tolerance) {
                continue;
            }
            *seen = match &view.silhouette {
                Some(s) => s.sample(pixel.x, pixel.y).is_some_and(|d| d > params.contour_pixels),
                None => true,
            };
        }
    }
    let unseen = seen.iter().enumerate().filter(|&(_, &seen)| !seen);
    let points = unseen.map(|(i, _)| Point {
        position: hull.positions[i],
        normal: hull.normals[i],
        fidelity: 0.0,
        sigma: 0.0,
        weight: 0.0,
        view: Point::NO_VIEW,
        rank: Rank::Implicit,
    });
    Ok(points.collect())
}
