//! Which views exclude the most plausible places of an uncovered pixel's ray.

use super::{
    super::{carver::Carver, space::Space},
    coverage::PIXELS_PER_SAMPLE,
    excluders::{NOBODY, Sets, TOLERATED},
};
use crate::{
    error::Result,
    progress::{self, Progress},
    stage::Stage,
};
use alloc::vec::Vec;

/// A view excludes a place that it sees by more than this outside its contour, in pixels.
const OUTSIDE: f32 = -1.0;
/// Smallest number of silhouettes that must contain a plausible place, and how many there must be per view that excludes
/// it. The view that the pixel belongs to is one of them.
const MIN_SUPPORT: u32 = 4;
const SUPPORT_PER_EXCLUSION: u32 = 4;
/// Number of places along a ray per cell of the searched space.
const PLACES_PER_CELL: f32 = 8.0;
/// Largest number of pixels of one view whose rays are followed. If there are more, each one stands for several.
const MOST: usize = 1000;

/// Follows the rays of a view's uncovered `pixels`. Returns, for each of them that is not in doubt, which views exclude its
/// most plausible places, those that the fewest views exclude, and the number of pixels that each of them stands for.
/// Contours may lie `off` by so many pixels more than usual.
pub(super) fn follow_rays(
    carvers: &[Carver],
    space: &Space,
    own: usize,
    pixels: &[[u16; 2]],
    off: f32,
    progress: &dyn Progress,
) -> Result<(f32, Vec<Sets>)> {
    let every = pixels.len().div_ceil(MOST).max(1);
    let mut found = Vec::new();
    for (n, &[x, y]) in pixels.iter().step_by(every).enumerate() {
        if n % 64 == 0 {
            progress::step(progress, Stage::Hull, own as u32, carvers.len() as u32)?;
        }
        found.extend(follow_ray(carvers, space, own, [f32::from(x), f32::from(y)], off));
    }
    Ok((PIXELS_PER_SAMPLE * every as f32, found))
}

/// The sets of views that exclude the places of a pixel's ray. `None` if some place is excluded by no view, or if all
/// places are implausible: then the pixel itself is in doubt.
fn follow_ray(carvers: &[Carver], space: &Space, own: usize, [x, y]: [f32; 2], off: f32) -> Option<Sets> {
    let camera = &carvers[own].camera;
    let ray = camera.ray(x, y);
    let unit = 1.0 / ray.length();
    let (fine, coarse) = (space.cell() * unit / PLACES_PER_CELL, 0.5 * space.cell() * unit);
    let end = space.reach(camera.centre) * unit;
    let mut found = Sets::new();
    let mut t = 0.0;
    while t < end {
        let p = camera.centre + ray * t;
        if !space.contains(p) {
            t += coarse;
            continue;
        }
        t += fine;
        let (mut set, mut excluding, mut support) = (NOBODY, 0, 1);
        for (u, carver) in carvers.iter().enumerate().filter(|&(u, _)| u != own) {
            match carver.pixels(p) {
                Some(d) if d < OUTSIDE - off => {
                    if excluding == TOLERATED {
                        excluding += 1;
                        break;
                    }
                    set[excluding as usize] = u as u16;
                    excluding += 1;
                }
                Some(_) => support += 1,
                None => {}
            }
        }
        if excluding <= TOLERATED && support >= MIN_SUPPORT.max(SUPPORT_PER_EXCLUSION * excluding) {
            if excluding == 0 {
                return None;
            }
            found.add(set);
        }
    }
    (found.iter().len() > 0).then_some(found)
}
