//! Parts that a silhouette lacks: holes and missing limbs whose colours are the object's and not the background's, and
//! along whose rays all other silhouettes agree that there is something.

use super::{super::carver::carvers, colours::ObjectColours, gaps::gaps, rays::Rays};
use crate::{
    colour_counts::bin,
    error::Result,
    executor::Executor,
    progress::{self, Progress},
    silhouette::{Silhouette, SilhouetteScratch},
    stage::Stage,
    view::View,
};
use alloc::{sync::Arc, vec, vec::Vec};
use glam::Vec3;

/// A pixel may belong to the object if its colour is at least this many times more frequent there.
const EVIDENCE: f32 = 8.0;
/// A part has at least this many pixels, and one of them is at least this far outside the contour, in pixels. Anything
/// smaller may be a fringe of mixed colours.
const MIN_PIXELS: usize = 24;
const MIN_DEPTH: f32 = -1.75;

/// A silhouette that lacked parts, with the parts added.
pub struct Completed {
    /// Place of the view in the rig's order.
    pub place: u16,
    /// The completed silhouette.
    pub silhouette: Arc<Silhouette>,
    /// Number of pixels that were added.
    pub added: u32,
}

/// The silhouettes that lack parts, with the parts added. `bounds` are those of the hull, and `footprint` is the size of a
/// pixel there, in scene units.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn completed(
    views: &[View],
    bounds: (Vec3, Vec3),
    footprint: f32,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<Completed>> {
    let carvers = carvers(views);
    let object = ObjectColours::new(views, executor);
    let completed = executor.map_with(&mut Vec::<SilhouetteScratch>::new(), carvers.len(), |scratch, own| {
        progress::step(progress, Stage::Hull, own as u32, carvers.len() as u32)?;
        let view = &views[usize::from(carvers[own].index)];
        let rays = Rays { carvers: &carvers, own, bounds, footprint };
        let silhouette = &carvers[own].silhouette;
        let added = lacking(view, silhouette, &object, &rays).or_else(|| gaps(views, view, silhouette, &rays, scratch));
        Ok(added.map(|added| Completed {
            place: carvers[own].index,
            silhouette: Arc::new(silhouette.with_added(&added, scratch)),
            added: added.iter().filter(|&&is_added| is_added).count() as u32,
        }))
    });
    completed.into_iter().filter_map(Result::transpose).collect()
}

/// Marks the pixels of the parts that a silhouette lacks. `None` if it lacks nothing.
fn lacking(view: &View, silhouette: &Silhouette, object: &ObjectColours, rays: &Rays) -> Option<Vec<bool>> {
    let (w, h) = (silhouette.width as usize, silhouette.height as usize);
    let distances = silhouette.distances();
    let evidence = object.against_background(view, silhouette);
    let may_belong = |i: usize| distances[i] <= 0 && evidence[bin(&view.rgb[3 * i..])] >= EVIDENCE;
    let [first, end] = rays.part_of_picture(w, h);
    let mut visited = vec![false; w * h];
    let mut added: Option<Vec<bool>> = None;
    let mut part: Vec<u32> = Vec::new();
    let deep = (MIN_DEPTH * Silhouette::UNITS) as i16;
    for y in first[1]..end[1] {
        for x in first[0]..end[0] {
            let start = y * w + x;
            // A part is found from a pixel that is deep enough, so that fringes cost nothing.
            if visited[start] || distances[start] > deep || !may_belong(start) {
                continue;
            }
            visited[start] = true;
            part.clear();
            part.push(start as u32);
            let mut next = 0;
            while next < part.len() {
                let i = part[next] as usize;
                next += 1;
                let (x, y) = (i % w, i / w);
                let near = [
                    (x > first[0], i.wrapping_sub(1)),
                    (x + 1 < end[0], i + 1),
                    (y > first[1], i.wrapping_sub(w)),
                    (y + 1 < end[1], i + w),
                ];
                for (is_there, j) in near {
                    if is_there && !visited[j] && may_belong(j) {
                        visited[j] = true;
                        part.push(j as u32);
                    }
                }
            }
            if part.len() >= MIN_PIXELS && rays.meet(&part, w) {
                let added = added.get_or_insert_with(|| vec![false; w * h]);
                part.iter().for_each(|&i| added[i as usize] = true);
            }
        }
    }
    added
}
