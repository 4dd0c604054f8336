//! Which silhouette is at fault where silhouettes disagree.
//!
//! What a silhouette shows beyond the hull was cut off by another view. A view at fault cuts off what all others show, and
//! shows what all others cut off; so the overlaps of all views suffer, and those of good views as much as its own. It is
//! found by asking who cut: along the ray of a pixel that the hull lacks, the place is sought that the fewest views
//! exclude, and if those are one or two, they are blamed. A view is at fault if several others blame it.

use super::diagnostics::Comparison;
use crate::view::View;
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Spacing of the places that are tested along a ray, in pixels of footprint.
const STEP_PIXELS: f32 = 4.0;
/// A view excludes a place outside its silhouette by more than this, and supports one inside by more, in pixels.
const CLEAR_PIXELS: f32 = 1.0;
/// A place counts if at least this share of the other views that see it support it.
const SUPPORT: f32 = 0.6;
/// Most views that are blamed for one pixel.
const MOST: usize = 2;
/// A view blames others only if the hull lacks at least this share of its silhouette.
const LEAST_LACK: f32 = 0.004;
/// Share of the pixels that a view lacks for which another one must be blamed, to be blamed by it.
const SHARE: f32 = 0.3;
/// Views that must blame a view.
const LEAST_BLAMING: u32 = 3;
/// Share of the blaming views that must blame a view.
const BLAMING_SHARE: f32 = 0.3;

/// The region around the object in which rays are followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Region {
    pub centre: Vec3,
    pub radius: f32,
    /// Size of a pixel there, in scene units.
    pub footprint: f32,
}

/// For each view, how many others its silhouette contradicts: zero unless it is at fault. In the order of the views.
pub(super) fn blame(views: &[View], compared: &[Comparison], region: Region) -> Vec<u32> {
    let mut blaming = vec![0u32; views.len()];
    let mut voters = 0u32;
    for (i, found) in compared.iter().enumerate() {
        if !views[i].is_used() || found.lacks < LEAST_LACK {
            continue;
        }
        let mut blamed = vec![0.0f32; views.len()];
        for pixel in &found.lacking {
            let excluding = least_excluding(views, i, *pixel, region);
            for &j in &excluding {
                blamed[j] += 1.0 / excluding.len() as f32;
            }
        }
        let total = found.lacking.len() as f32;
        voters += 1;
        for (count, blamed) in blaming.iter_mut().zip(blamed) {
            *count += u32::from(blamed >= SHARE * total);
        }
    }
    let least = LEAST_BLAMING.max(libm::ceilf(BLAMING_SHARE * voters as f32) as u32);
    blaming.into_iter().map(|count| if count >= least { count } else { 0 }).collect()
}

/// The views that exclude the place on a pixel's ray that fewest exclude, among those that enough views support. Empty if
/// these are none, or more than [`MOST`].
fn least_excluding(views: &[View], own: usize, pixel: [u16; 2], region: Region) -> Vec<usize> {
    let camera = &views[own].camera;
    let ray = camera.ray(f32::from(pixel[0]), f32::from(pixel[1]));
    let unit = ray.length_squared();
    let middle = (region.centre - camera.centre).dot(ray) / unit;
    let reach = region.radius / libm::sqrtf(unit);
    let step = STEP_PIXELS * region.footprint / libm::sqrtf(unit);
    let (mut best, mut best_support): (Option<Vec<usize>>, f32) = (None, 0.0);
    let steps = libm::ceilf(2.0 * reach / step) as u32;
    let mut excluding = Vec::new();
    for k in 0..=steps {
        let t = middle - reach + step * k as f32;
        if t <= 0.0 {
            continue;
        }
        let p = camera.centre + ray * t;
        excluding.clear();
        let (mut supporting, mut seen) = (0u32, 0u32);
        for (j, view) in views.iter().enumerate().filter(|&(j, view)| j != own && view.is_used()) {
            let Some(silhouette) = &view.silhouette else { continue };
            let q = view.camera.project(p);
            let Some(d) = (q.z > 0.0).then(|| silhouette.sample(q.x, q.y)).flatten() else { continue };
            seen += 1;
            supporting += u32::from(d > CLEAR_PIXELS);
            if d < -CLEAR_PIXELS {
                excluding.push(j);
                if excluding.len() > MOST {
                    break;
                }
            }
        }
        let support = supporting as f32 / seen.max(1) as f32;
        if excluding.len() > MOST || supporting < 2 || support < SUPPORT {
            continue;
        }
        let fewer = best.as_ref().is_none_or(|best| {
            excluding.len() < best.len() || (excluding.len() == best.len() && support > best_support)
        });
        if fewer {
            (best, best_support) = (Some(excluding.clone()), support);
        }
    }
    best.unwrap_or_default()
}
