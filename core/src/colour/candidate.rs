//! What a view offers for a vertex's colour.

use super::depth::DepthBuffer;
use crate::{
    math::{min, sqrt},
    view::View,
};
use glam::{Vec2, Vec3};

/// Views that look along the surface (cosine between normal and ray below this) show mostly its neighbours.
const MIN_COSINE: f32 = 0.15;
/// From how many pixels inside the contour and off depth steps a pixel shows one surface only: lens blur, demosaicing
/// and JPEG mix colours over about that distance.
const CLEAN_PIXELS: f32 = 2.5;
/// Nearer to a contour or step than this a pixel is mixed with what lies behind: what surrounds the vertex knows its
/// colour better.
const MIXED_PIXELS: f32 = 1.0;
/// What the least clean pixel counts against a clean one: taken only if no camera offers better.
const MIN_CLEANNESS: f32 = 0.02;
/// A view's candidate for a vertex's colour.
#[derive(Debug, Clone, Copy)]
pub(super) struct Candidate {
    /// How well the view faces the vertex, and how clean the pixel is; greater is better.
    pub score: f32,
    pub view: u16,
    pub rgb: Vec3,
}

/// A view's candidate for a vertex, if the view sees it.
pub(super) fn sample_view(
    view: &View,
    index: u16,
    buffer: &DepthBuffer,
    position: Vec3,
    normal: Vec3,
    vertex: usize,
) -> Option<Candidate> {
    let ray = position - view.camera.centre;
    let cosine = -ray.dot(normal) / sqrt(ray.length_squared() * normal.length_squared());
    if cosine.is_nan() || cosine < MIN_COSINE {
        return None;
    }
    let pixel = buffer.projected(vertex);
    let footprint = view.camera.footprint(pixel.z);
    // The tangent plane's inverse depth is linear in the image: what its slope explains hides nothing. The rest of the
    // tolerance is for curvature, and for normals that are slightly off.
    let here = view.camera.ray(pixel.x, pixel.y);
    let right = view.camera.ray(pixel.x + 1.0, pixel.y) - here;
    let down = view.camera.ray(pixel.x, pixel.y + 1.0) - here;
    let gradient = Vec2::new(normal.dot(right), normal.dot(down)) / normal.dot(ray);
    let slope = sqrt(1.0 - min(cosine * cosine, 1.0)) / cosine;
    let border = buffer.visible(pixel, gradient, footprint * (1.5 + 0.5 * slope))?;
    let contour = match &view.silhouette {
        Some(silhouette) => silhouette.sample(pixel.x, pixel.y)?,
        None => CLEAN_PIXELS,
    };
    let clean = min(border, contour);
    if clean < MIXED_PIXELS {
        return None;
    }
    let cleanness = ((clean - MIXED_PIXELS) / (CLEAN_PIXELS - MIXED_PIXELS)).clamp(MIN_CLEANNESS, 1.0);
    Some(Candidate { score: cosine * cleanness, view: index, rgb: sample(view, pixel.x, pixel.y, cleanness)? })
}

/// Keeps the best candidates in falling order. Among equal ones the earlier view's stays ahead.
pub(super) fn insert_best(best: &mut [Candidate], mut candidate: Candidate) {
    for kept in best {
        if candidate.score > kept.score {
            core::mem::swap(kept, &mut candidate);
        }
    }
}

/// Sample of the picture between bilinear and Catmull-Rom (`sharpness` 1), whose wider kernel would reach across a near
/// contour; `None` too close to the picture's edge.
fn sample(view: &View, u: f32, v: f32, sharpness: f32) -> Option<Vec3> {
    let (w, h) = (view.camera.width as usize, view.camera.height as usize);
    if !(u >= 1.0 && v >= 1.0 && u < w as f32 - 2.0 && v < h as f32 - 2.0) {
        return None;
    }
    let (x, y) = (u as usize, v as usize);
    let kernel = |t: f32| {
        let (t2, t3) = (t * t, t * t * t);
        let bend = [2.0 * t2 - t3 - t, 3.0 * t3 - 5.0 * t2 + 2.0 * t, t + 4.0 * t2 - 3.0 * t3 - 2.0 * t, t3 - t2];
        let linear = [0.0, 1.0 - t, t, 0.0];
        [0, 1, 2, 3].map(|k| linear[k] + bend[k] * (0.5 * sharpness))
    };
    let (across, down) = (kernel(u - x as f32), kernel(v - y as f32));
    let mut sum = Vec3::ZERO;
    for (k, weight) in down.into_iter().enumerate() {
        let row = &view.rgb[((y + k - 1) * w + x - 1) * 3..][..12];
        for (pixel, a) in row.chunks_exact(3).zip(across) {
            sum += Vec3::new(f32::from(pixel[0]), f32::from(pixel[1]), f32::from(pixel[2])) * (a * weight);
        }
    }
    Some(sum.clamp(Vec3::ZERO, Vec3::splat(255.0)))
}
