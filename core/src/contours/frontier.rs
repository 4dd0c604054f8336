//! §4.4: frontier points, at which the ray of a contour pixel certainly touches the surface.

use crate::{
    hull::{VisualHull, Walk},
    math::{max, sqrt},
    point_cloud::{Point, PointCloud, Rank},
    surface::SLOPE,
    view::View,
};
use glam::Vec3;

/// Parameters of frontier points (§4.4).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct FrontierParams {
    /// τ: the longest interval of a contour pixel's ray inside the hull of the other views, in pixels of footprint.
    pub longest_pixels: f32,
    /// What makes a frontier point certain.
    pub certainty: Certainty,
}

/// What makes a frontier point certain. Its fidelity is its certainty, which is at most 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "lowercase"))]
pub enum Certainty {
    /// A short interval: it decreases linearly from 1 to 0 for the longest interval.
    Interval,
    /// A small variance: it is inversely proportional to the variance of the point.
    Precision,
}

/// Smallest standard deviation of a frontier point in pixels: that of cameras and undistortion. Frontier points of
/// captures whose contours are known to 0.1 pixel lie within 0.15 to 0.3 pixels of the surface.
const LEAST_SIGMA: f32 = 0.25;
/// Standard deviation of a contour of unknown precision, in pixels.
const GIVEN_SIGMA: f32 = 0.25;
/// Radius of curvature of a thin limb in pixels: that of the surface along the ray. In the middle of an interval of
/// length L the surface is up to L² / 8 R below the ray.
const LIMB_RADIUS: f32 = 25.0;

/// Standard deviation along the normal in pixels of footprint, from that of the contour and the length of the interval
/// in pixels of footprint. The contour's is in pixels of this view's picture, which are taken as pixels of footprint.
fn deviation(contour: Option<f32>, length: f32) -> f32 {
    let contour = contour.unwrap_or(GIVEN_SIGMA);
    let sag = length * length / (8.0 * LIMB_RADIUS);
    sqrt(LEAST_SIGMA * LEAST_SIGMA + contour * contour + sag * sag)
}

/// Fraction of a signed distance by which a ray may safely advance. A signed distance d changes by at most [`SLOPE`]
/// per unit of length, so that its sign is constant within d / [`SLOPE`] = 0.77 d. The rest is a margin for
/// interpolated distances.
const SAFE_FRACTION: f32 = 0.7;
const _: () = assert!(SAFE_FRACTION * SLOPE < 1.0);

/// A ray that misses the hull of the other views by less than this still touches the surface, in pixels of footprint:
/// the contours are not more accurate.
const MISS_PIXELS: f32 = 0.7;

/// The frontier points of a view.
///
/// The ray of a contour pixel touches the surface somewhere. If the hull of the other views leaves it a single short
/// interval, then that is where it touches. The normal follows from the contour.
pub fn frontier(view: &View, hull: &VisualHull, params: &FrontierParams) -> PointCloud {
    let mut cloud = PointCloud::new();
    let Some(silhouette) = view.silhouette.as_ref().filter(|_| view.is_used()) else { return cloud };
    let footprint = hull.footprint();
    let longest = params.longest_pixels * footprint;
    silhouette.contour(|pixel, outward| {
        let ray = view.camera.ray(pixel.x, pixel.y);
        let Some((t, length)) = touch(hull, view, ray, longest) else { return };
        let position = view.camera.centre + ray * t;
        let (rows, _) = view.camera.projection();
        // The tangent of the contour and the camera's centre span the tangent plane of the surface.
        let normal = rows[0] * outward.x + rows[1] * outward.y - rows[2] * outward.dot(pixel);
        let normal = normal.normalize_or_zero();
        let sigma = deviation(silhouette.contour_sigma(pixel.x, pixel.y), length / footprint);
        let certainty = match params.certainty {
            Certainty::Interval => 1.0 - length / longest,
            Certainty::Precision => LEAST_SIGMA * LEAST_SIGMA / (sigma * sigma),
        };
        cloud.push(Point {
            position,
            normal,
            fidelity: certainty,
            sigma,
            weight: 0.0,
            view: view.index,
            rank: Rank::Frontier,
        });
    });
    cloud
}

/// Where the ray of a contour pixel meets the hull of the other views: the middle and the length of its interval, if
/// there is only one and it is short. A ray that misses the hull by less than [`MISS_PIXELS`] touches it where it comes
/// nearest.
fn touch(hull: &VisualHull, view: &View, ray: Vec3, longest: f32) -> Option<(f32, f32)> {
    let unit = 1.0 / ray.length();
    let fine = hull.footprint() * unit;
    let (mut t, end) = hull.span(view.camera.centre, ray)?;
    let mut inside = None;
    let mut piece: Option<(f32, f32)> = None;
    let mut others = Walk::new(hull, view.index);
    let (mut nearest, mut nearest_at) = (f32::NEG_INFINITY, 0.0);
    while t < end {
        let p = view.camera.centre + ray * t;
        if inside.is_none() {
            let coarse = hull.coarse(p);
            if coarse < -2.0 * hull.footprint() {
                t += max(-coarse * SAFE_FRACTION * unit, fine);
                continue;
            }
        }
        // Blocks outside were carved by other views, because the contour of this view passes through them.
        let (d, step) = match hull.outside_block(p, ray) {
            Some(step) => (-2.0 * hull.footprint(), step + 0.01 * fine),
            None => {
                let d = others.signed_distance(p, 2.0 * hull.footprint());
                (d, max(d.abs() * SAFE_FRACTION * unit, fine))
            }
        };
        if d > nearest {
            (nearest, nearest_at) = (d, t);
        }
        match (d > 0.0, inside) {
            (true, None) => inside = Some(t),
            (true, Some(start)) if (t - start) > longest * unit => return None,
            (false, Some(start)) => {
                if piece.is_some() {
                    return None;
                }
                piece = Some((start, t));
                inside = None;
            }
            _ => {}
        }
        t += step;
    }
    match piece {
        Some((start, stop)) => {
            let length = (stop - start) / unit;
            (length < longest).then_some((0.5 * (start + stop), length))
        }
        None => (nearest > -MISS_PIXELS * hull.footprint()).then_some((nearest_at, 0.0)),
    }
}
