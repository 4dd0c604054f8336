//! §4.4: frontier points, where a silhouette's contour touches the surface.

use crate::{
    hull::{VisualHull, Walk},
    math::max,
    point_cloud::{Point, PointCloud, Rank},
    silhouette::Silhouette,
    view::View,
};
use glam::{Vec2, Vec3};

/// Frontier points of §4.4.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct FrontierParams {
    /// τ: a contour pixel's ray may run this long inside the other views' hull, in pixels of footprint.
    pub longest_pixels: f32,
}

/// The frontier points of a view.
///
/// A contour pixel's ray touches the surface somewhere. Where all other silhouettes leave it a single, short piece,
/// that piece is the place, and its normal is known from the contour.
pub fn frontier(view: &View, hull: &VisualHull, params: &FrontierParams) -> PointCloud {
    let mut cloud = PointCloud::new();
    let Some(silhouette) = &view.silhouette else { return cloud };
    let footprint = hull.footprint();
    let longest = params.longest_pixels * footprint;
    contour(silhouette, |pixel, outward| {
        let ray = view.camera.ray(pixel.x, pixel.y);
        let Some((t, length)) = touch(hull, view, ray, longest) else { return };
        let position = view.camera.centre + ray * t;
        let (rows, _) = view.camera.projection();
        // The contour's tangent line and the camera's centre span the tangent plane of the surface.
        let normal = rows[0] * outward.x + rows[1] * outward.y - rows[2] * outward.dot(pixel);
        let normal = normal.normalize_or_zero();
        let certainty = 1.0 - length / longest;
        cloud.push(Point {
            position,
            normal,
            fidelity: certainty,
            weight: 0.0,
            view: view.index,
            rank: Rank::Frontier,
        });
    });
    cloud
}

/// Calls `f` with a point of the contour and its outward unit normal in the image, once for every pixel cell that the
/// contour passes.
fn contour(silhouette: &Silhouette, mut f: impl FnMut(Vec2, Vec2)) {
    let (w, h) = (silhouette.width as usize, silhouette.height as usize);
    let d = silhouette.distances();
    for y in 0..h - 1 {
        for x in 0..w - 1 {
            let i = y * w + x;
            let corners = [d[i], d[i + 1], d[i + w], d[i + w + 1]];
            let inside = corners.iter().filter(|&&v| v > 0).count();
            if inside == 0 || inside == 4 || corners.contains(&Silhouette::UNKNOWN) {
                continue;
            }
            let [a, b, c, e] = corners.map(f32::from);
            // The plane through the four corners: value at the cell's middle and gradient.
            let middle = 0.25 * (a + b + c + e);
            let gradient = Vec2::new(0.5 * (b + e - a - c), 0.5 * (c + e - a - b));
            let length = gradient.length_squared();
            if length > 0.0 {
                let offset = gradient * (-middle / length);
                if offset.x.abs() <= 0.5 && offset.y.abs() <= 0.5 {
                    let pixel = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + offset;
                    f(pixel, -gradient.normalize_or_zero());
                }
            }
        }
    }
}

/// Where a contour ray meets the hull of the other views: parameter and length of the piece, if there is only one and
/// it is short. Rays that just miss the hull by the contours' uncertainty touch it where they come nearest.
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
        let coarse = hull.coarse(p);
        if coarse < -2.0 * hull.footprint() && inside.is_none() {
            t += max(-coarse * 0.7 * unit, fine);
            continue;
        }
        // Such a block is carved by other views: this one's contour passes through it.
        let (d, step) = match hull.outside_block(p, ray) {
            Some(step) => (-2.0 * hull.footprint(), step + 0.01 * fine),
            None => {
                let d = others.signed_distance(p, 2.0 * hull.footprint());
                (d, max(d.abs() * 0.7 * unit, fine))
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
        None => (nearest > -0.7 * hull.footprint()).then_some((nearest_at, 0.0)),
    }
}
