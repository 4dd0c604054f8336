//! The candidate that a view provides for the colour of a point of the surface (§7).

use super::depth::DepthBuffer;
use crate::{
    math::{min, sqrt},
    view::View,
};
use glam::{Vec2, Vec3};

/// Views with a smaller cosine between normal and ray are not used. They look along the surface and mostly show its
/// surroundings.
const MIN_COSINE: f32 = 0.15;
/// At this distance in pixels from the contour and from depth steps, a pixel shows a single surface. Lens blur,
/// demosaicing and JPEG mix colours over about that distance.
const CLEAN_PIXELS: f32 = 2.5;
/// Pixels closer than this to a contour or depth step are mixed with the background and are not used. The colours of
/// adjacent vertices are a better estimate.
const MIXED_PIXELS: f32 = 1.0;
/// Smallest cleanness of a pixel, relative to a clean one. Such a pixel is used only if no camera has a better one.
const MIN_CLEANNESS: f32 = 0.02;

/// A view's candidate for the colour of a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    /// Cosine between normal and ray, times the cleanness of the pixel. Larger is better.
    pub score: f32,
    pub view: u16,
    pub rgb: Vec3,
}

impl Candidate {
    /// Stands for the candidate of no view.
    pub(super) const NONE: Self = Self { score: 0.0, view: u16::MAX, rgb: Vec3::ZERO };
}

/// A view's candidate for a point of the surface, or `None` if the view does not see it. `pixel` is the point's projection:
/// position in the picture, and depth.
pub(super) fn sample_view(
    view: &View,
    index: u16,
    buffer: &DepthBuffer,
    position: Vec3,
    normal: Vec3,
    pixel: Vec3,
) -> Option<Candidate> {
    let ray = position - view.camera.centre;
    let cosine = -ray.dot(normal) / sqrt(ray.length_squared() * normal.length_squared());
    if cosine.is_nan() || cosine < MIN_COSINE {
        return None;
    }
    let footprint = view.camera.footprint(pixel.z);
    // The inverse depth of the tangent plane is linear in the image. Depth differences that follow from its slope are
    // not occlusions. The rest of the tolerance allows for curvature and slightly wrong normals.
    let here = view.camera.ray(pixel.x, pixel.y);
    let right = view.camera.ray(pixel.x + 1.0, pixel.y) - here;
    let down = view.camera.ray(pixel.x, pixel.y + 1.0) - here;
    let gradient = Vec2::new(normal.dot(right), normal.dot(down)) / normal.dot(ray);
    let slope = sqrt(1.0 - min(cosine * cosine, 1.0)) / cosine;
    let border = buffer.visible(pixel, gradient, footprint * (1.5 + 0.5 * slope))?;
    let contour = match view.shown() {
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

/// Inserts a candidate into the best ones, which are in descending order. Among equal candidates the earlier view comes
/// first.
pub(super) fn insert_best(best: &mut [Candidate], mut candidate: Candidate) {
    for kept in best {
        if candidate.score > kept.score {
            core::mem::swap(kept, &mut candidate);
        }
    }
}

/// Samples the picture by a blend of bilinear (`sharpness` 0) and Catmull-Rom interpolation (`sharpness` 1). Close to a
/// contour the wider kernel of Catmull-Rom would reach across it. `None` too close to the picture's edge.
///
/// The fixed-point kernel of `undistort.rs` cannot be used here, because it has neither the blend nor continuous
/// positions.
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
