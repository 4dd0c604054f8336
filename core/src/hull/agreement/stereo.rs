//! Whether views other than a ray's own see a surface along it.

use super::rays::Rays;
use crate::{
    camera::Pinhole,
    image::bilinear,
    math::{max, sqrt},
    sort::short_by,
    view::View,
};
use alloc::vec::Vec;
use core::ops::ControlFlow;
use glam::Vec3;

/// Largest number of views that are compared: those that look most nearly along the ray.
const VIEWS: usize = 5;
/// They look along it by at least this cosine: 60°.
const MIN_COSINE: f32 = 0.5;
/// The surface is at least this far inside their contours, in pixels: a patch reaches that far.
const INSIDE: f32 = 5.0;
/// Distance of the places that are tried, in pixels of footprint.
const STEP: f32 = 1.0;
/// Samples along the edge of a patch.
const EDGE: usize = 7;
/// A patch of less contrast, as its standard deviation in levels, matches anything.
const MIN_CONTRAST: f32 = 3.0;
/// Patches agree if their ZNCC is at least this, and a surface is found where so many pairs of views agree.
const MIN_ZNCC: f32 = 0.8;
const MIN_PAIRS: usize = 3;

/// Luma of a patch less its mean, divided by its norm.
type Patch = [f32; EDGE * EDGE];

/// The views that look for a surface.
pub(super) struct Stereo<'a> {
    pub views: &'a [View],
    pub rays: &'a Rays<'a>,
}

impl Stereo<'_> {
    /// Whether the other views see a surface along a pixel's ray, where it first runs inside their hull. Patches reach
    /// `reach` pixels of the ray's view to each side.
    pub fn finds_surface(&self, x: f32, y: f32, reach: f32) -> bool {
        let mut others: Option<Vec<&View>> = None;
        let mut found = false;
        let _ = self.rays.walk(x, y, STEP, |place| {
            match (place, &others) {
                (None, None) => {}
                (None, Some(_)) => return ControlFlow::Break(()),
                (Some(depth), _) => {
                    let others = others.get_or_insert_with(|| self.nearest(x, y, depth));
                    found = self.agree(others, x, y, depth, reach);
                }
            }
            if found { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        found
    }

    /// The camera of the ray's own view.
    fn camera(&self) -> &Pinhole {
        &self.rays.carvers[self.rays.own].camera
    }

    /// The other views that look along a ray at the given depth, the most nearly first.
    fn nearest(&self, x: f32, y: f32, depth: f32) -> Vec<&View> {
        let own = &self.rays.carvers[self.rays.own];
        let ray = own.camera.ray(x, y).normalize();
        let p = own.camera.centre + own.camera.ray(x, y) * depth;
        let mut found: Vec<(f32, &View)> = (self.views.iter())
            .filter(|view| view.index != own.index && view.is_used())
            .map(|view| ((p - view.camera.centre).normalize().dot(ray), view))
            .filter(|&(cosine, _)| cosine >= MIN_COSINE)
            .collect();
        // Among equals the earlier view comes first.
        short_by(&mut found, |a, b| b.0.total_cmp(&a.0));
        found.into_iter().map(|(_, view)| view).collect()
    }

    /// Whether enough pairs of views show the same at a place of a ray.
    fn agree(&self, others: &[&View], x: f32, y: f32, depth: f32, reach: f32) -> bool {
        let camera = self.camera();
        let step = reach / (EDGE / 2) as f32;
        let corner = camera.ray(x - reach, y - reach);
        let (right, down) = (camera.ray(x + step, y) - camera.ray(x, y), camera.ray(x, y + step) - camera.ray(x, y));
        let place =
            |column: usize, row: usize| camera.centre + (corner + right * column as f32 + down * row as f32) * depth;
        let (mut patches, mut count) = ([[0.0; EDGE * EDGE]; VIEWS], 0);
        let seen = others.iter().filter(|view| shows(view, camera.centre + camera.ray(x, y) * depth));
        for found in seen.take(VIEWS).filter_map(|view| patch(view, place)) {
            patches[count] = found;
            count += 1;
        }
        let patches = &patches[..count];
        let zncc = |a: &Patch, b: &Patch| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>();
        let pairs = patches.iter().enumerate().flat_map(|(i, a)| patches[i + 1..].iter().map(move |b| zncc(a, b)));
        pairs.filter(|&zncc| zncc >= MIN_ZNCC).count() >= MIN_PAIRS
    }
}

/// Whether a view shows the object around the projection of a place.
fn shows(view: &View, p: Vec3) -> bool {
    let q = view.camera.project(p);
    q.z > 0.0 && view.shown().and_then(|shown| shown.sample(q.x, q.y)).is_some_and(|d| d >= INSIDE)
}

/// A view's patch of the places that `at` gives for a column and a row. `None` if the view does not see it as a whole, or
/// if it has too little contrast.
fn patch(view: &View, at: impl Fn(usize, usize) -> Vec3) -> Option<Patch> {
    let mut patch = [0.0; EDGE * EDGE];
    for (i, value) in patch.iter_mut().enumerate() {
        *value = luma(view, at(i % EDGE, i / EDGE))?;
    }
    let mean = patch.iter().sum::<f32>() / (EDGE * EDGE) as f32;
    patch.iter_mut().for_each(|v| *v -= mean);
    let norm = sqrt(patch.iter().map(|v| v * v).sum());
    if norm < MIN_CONTRAST * EDGE as f32 {
        return None;
    }
    let scale = 1.0 / max(norm, f32::MIN_POSITIVE);
    Some(patch.map(|v| v * scale))
}

/// A view's luma at the projection of a place, interpolated bilinearly.
fn luma(view: &View, p: Vec3) -> Option<f32> {
    let q = view.camera.project(p);
    let size = [view.camera.width as usize, view.camera.height as usize];
    bilinear(&view.luma, size, q.x, q.y).filter(|_| q.z > 0.0)
}
