//! View-independent colours of a mesh (§7): each vertex takes the pixel of the camera that faces it best and sees it.

mod depth;
mod fill;
mod gains;

use crate::{
    error::Result,
    math::{min, sqrt},
    params::ColourParams,
    point_cloud::Mesh,
    progress::{self, Progress, Stage},
    view::View,
    workspace::Workspace,
};
use alloc::{vec, vec::Vec};
use depth::DepthBuffer;
use glam::{Vec2, Vec3};

/// Views that look along the surface (cosine between normal and ray below this) show mostly its neighbours.
const LEAST_COSINE: f32 = 0.15;
/// From how many pixels inside the contour and off depth steps a pixel shows one surface only: lens blur, demosaicing
/// and JPEG mix colours over about that distance.
const CLEAN_PIXELS: f32 = 2.5;
/// Nearer to a contour or step than this a pixel is mixed with what lies behind: what surrounds the vertex knows its
/// colour better.
const MIXED_PIXELS: f32 = 1.0;
/// What the least clean pixel counts against a clean one: taken only if no camera offers better.
const LEAST_CLEANNESS: f32 = 0.02;
/// Blending weight falls with this power of the cosine.
const BLEND_POWER: i32 = 4;

/// A view's offer for a vertex's colour.
#[derive(Debug, Clone, Copy)]
struct Offer {
    /// How well the view faces the vertex, and how clean the pixel is; greater is better.
    score: f32,
    view: u16,
    rgb: Vec3,
}

/// Colours the mesh from the views that see it.
///
/// Each vertex takes the interpolated pixel of the camera whose ray is most opposed to its normal
/// ([`ColourParams::blended_views`] = 1, the paper's choice), or a blend of the best few that has no seams. Vertices
/// that no camera sees continue the colours around them. Colours are sRGB, like the pictures. `fixed_gains`, one a view,
/// are used instead of gains found here; the gains used come back.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn colour(
    mesh: &mut Mesh,
    views: &[View],
    fixed_gains: Option<&[Vec3]>,
    params: &ColourParams,
    workspace: &mut Workspace,
    progress: &dyn Progress,
) -> Result<Vec<Vec3>> {
    // A step a view, one for the gains, one for the blend.
    let step = |done: u32| progress::step(progress, Stage::Colour, done, views.len() as u32 + 2);
    let compared = params.gains && fixed_gains.is_none();
    let blended = params.blended_views.max(1) as usize;
    // Blending needs the best view that is left out as well.
    let kept = if blended == 1 { 1 } else { blended + 1 };
    let none = Offer { score: 0.0, view: u16::MAX, rgb: Vec3::ZERO };
    let mut offers: Vec<Offer> = workspace.filled(none, mesh.positions.len() * kept);
    let mut overlap = gains::Overlap::new(mesh.positions.len(), views.len(), workspace);
    let mut buffer = DepthBuffer::in_memory(workspace);
    for (i, view) in views.iter().enumerate() {
        buffer.render(mesh, &view.camera);
        for (v, (&position, &normal)) in mesh.positions.iter().zip(&mesh.normals).enumerate() {
            let Some(offer) = look(view, i as u16, &buffer, position, normal, v) else { continue };
            if compared {
                overlap.add(v, i, &offer);
            }
            insert(&mut offers[v * kept..][..kept], offer);
        }
        step(i as u32 + 1)?;
    }
    let gains = match fixed_gains {
        Some(gains) => gains.to_vec(),
        None if compared => overlap.solve(workspace),
        None => vec![Vec3::ONE; views.len()],
    };
    buffer.keep_in(workspace);
    overlap.keep_in(workspace);
    step(views.len() as u32 + 1)?;
    let mut seen: Vec<Option<Vec3>> = workspace.empty(mesh.positions.len());
    seen.extend(offers.chunks_exact(kept).map(|offers| blend(offers, blended, &gains)));
    workspace.keep(offers);
    step(views.len() as u32 + 2)?;
    let mut colours = workspace.empty(seen.len());
    fill::fill(mesh, &seen, &mut colours);
    mesh.colours.clear();
    mesh.colours.extend(colours.iter().map(|c| c.to_array().map(|v| libm::roundf(v.clamp(0.0, 255.0)) as u8)));
    workspace.keep(seen);
    workspace.keep(colours);
    Ok(gains)
}

/// What a view has to say about a vertex, if it sees it.
fn look(view: &View, index: u16, buffer: &DepthBuffer, position: Vec3, normal: Vec3, vertex: usize) -> Option<Offer> {
    let ray = position - view.camera.centre;
    let cosine = -ray.dot(normal) / sqrt(ray.length_squared() * normal.length_squared());
    if cosine.is_nan() || cosine < LEAST_COSINE {
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
    let cleanness = ((clean - MIXED_PIXELS) / (CLEAN_PIXELS - MIXED_PIXELS)).clamp(LEAST_CLEANNESS, 1.0);
    Some(Offer { score: cosine * cleanness, view: index, rgb: sample(view, pixel.x, pixel.y, cleanness)? })
}

/// Keeps the best offers in falling order; of equal ones the earlier view's stays ahead.
fn insert(offers: &mut [Offer], mut offer: Offer) {
    for kept in offers {
        if offer.score > kept.score {
            core::mem::swap(kept, &mut offer);
        }
    }
}

/// The vertex's colour, `None` without any offer. Weights fall to zero towards the first view left out, so that the
/// colour does not jump where the order of views changes.
fn blend(offers: &[Offer], blended: usize, gains: &[Vec3]) -> Option<Vec3> {
    let seen = offers.iter().take_while(|o| o.score > 0.0).count();
    if seen == 0 {
        return None;
    }
    let colour = |o: &Offer| o.rgb * gains[o.view as usize];
    if blended == 1 {
        return Some(colour(&offers[0]));
    }
    let weight = |o: &Offer| (0..BLEND_POWER).fold(1.0, |w, _| w * o.score);
    let left_out = if seen > blended { weight(&offers[blended]) } else { 0.0 };
    let (mut sum, mut total) = (Vec3::ZERO, 0.0);
    for offer in &offers[..seen.min(blended)] {
        // A trace of the first view's own weight keeps the sum positive where all are equal.
        let w = weight(offer) * 1.001 - left_out;
        sum += colour(offer) * w;
        total += w;
    }
    Some(sum / total)
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

#[cfg(test)]
mod tests;
