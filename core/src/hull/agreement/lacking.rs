//! Parts that a silhouette lacks: holes and missing limbs whose colours are the object's and not the background's, and
//! along whose rays all other silhouettes agree that there is something.

use super::{
    super::carver::{Carver, carvers},
    colours::{ObjectColours, bin},
};
use crate::{
    error::Result,
    progress::{self, Progress},
    silhouette::Silhouette,
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
/// Largest number of a part's pixels whose rays are followed, and the share of them that must meet the hull of the other
/// views.
const RAYS: usize = 48;
const MIN_SHARE: f32 = 0.9;
/// Shortest piece of a ray inside the hull of the other views that counts, and the step along a ray, in pixels of footprint.
const MIN_LENGTH: f32 = 12.0;
const STEP: f32 = 4.0;
/// Smallest number of silhouettes that must contain a place of a ray.
const MIN_SUPPORT: u32 = 3;

/// A silhouette that lacked parts, with the parts added.
pub struct Completed {
    /// Place of the view in the rig's order.
    pub place: u16,
    /// The completed silhouette.
    pub silhouette: Arc<Silhouette>,
    /// Number of pixels that were added.
    pub added: u32,
}

/// The silhouettes that lack parts, with the parts added. `bounds` are those of the hull, and `footprint` is the size of a pixel there, in scene units.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn completed(
    views: &[View],
    bounds: (Vec3, Vec3),
    footprint: f32,
    progress: &dyn Progress,
) -> Result<Vec<Completed>> {
    let carvers = carvers(views);
    let object = ObjectColours::new(views);
    let mut completed = Vec::new();
    for own in 0..carvers.len() {
        progress::step(progress, Stage::Hull, own as u32, carvers.len() as u32)?;
        let view = &views[usize::from(carvers[own].index)];
        let rays = Rays { carvers: &carvers, own, bounds, footprint };
        if let Some(added) = lacking(view, &carvers[own].silhouette, &object, &rays) {
            completed.push(Completed {
                place: carvers[own].index,
                silhouette: Arc::new(carvers[own].silhouette.with_added(&added)),
                added: added.iter().filter(|&&is_added| is_added).count() as u32,
            });
        }
    }
    Ok(completed)
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

/// Rays of a view through the hull of the other views.
struct Rays<'a> {
    carvers: &'a [Carver],
    own: usize,
    bounds: (Vec3, Vec3),
    footprint: f32,
}

impl Rays<'_> {
    /// First and last column and row of the part of the picture in which the hull may lie.
    fn part_of_picture(&self, w: usize, h: usize) -> [[usize; 2]; 2] {
        let camera = &self.carvers[self.own].camera;
        let (low, high) = self.bounds;
        let corners = (0..8).map(|k| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
            camera.project(Vec3::new(pick(0), pick(1), pick(2)))
        });
        let (mut first, mut last) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for q in corners {
            if q.z <= 0.0 {
                return [[0, 0], [w, h]];
            }
            (first, last) = (first.min(q), last.max(q));
        }
        let clamp = |v: f32, n: usize| v.clamp(0.0, n as f32) as usize;
        [[clamp(first.x, w), clamp(first.y, h)], [clamp(last.x + 1.0, w), clamp(last.y + 1.0, h)]]
    }

    /// Whether the rays of most pixels of a part meet the hull of the other views.
    fn meet(&self, part: &[u32], width: usize) -> bool {
        let every = part.len().div_ceil(RAYS);
        let followed = part.len().div_ceil(every);
        let met = part.iter().step_by(every).filter(|&&i| {
            let i = i as usize;
            self.meets((i % width) as f32, (i / width) as f32)
        });
        met.count() as f32 >= MIN_SHARE * followed as f32
    }

    /// Whether a pixel's ray meets the hull of the other views in a piece that is long enough.
    fn meets(&self, x: f32, y: f32) -> bool {
        let camera = &self.carvers[self.own].camera;
        let ray = camera.ray(x, y);
        let unit = 1.0 / ray.length();
        let (low, high) = self.bounds;
        let (middle, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
        let from = (middle - camera.centre).length();
        let step = STEP * self.footprint * unit;
        let (mut t, end) = ((from - radius).max(0.0) * unit, (from + radius) * unit);
        let (mut length, mut excluding) = (0.0, 0);
        while t < end {
            let p = camera.centre + ray * t;
            t += step;
            // The view that excluded the last place will mostly exclude this one as well.
            if excluding != self.own && self.carvers[excluding].pixels(p).is_some_and(|d| d < 0.0) {
                length = 0.0;
                continue;
            }
            let mut support = 0;
            let excluded = self.carvers.iter().enumerate().filter(|&(i, _)| i != self.own).find(|(_, carver)| {
                let d = carver.pixels(p);
                support += u32::from(d.is_some());
                d.is_some_and(|d| d < 0.0)
            });
            if let Some((by, _)) = excluded {
                excluding = by;
            }
            if excluded.is_some() || support < MIN_SUPPORT {
                length = 0.0;
                continue;
            }
            length += STEP;
            if length >= MIN_LENGTH {
                return true;
            }
        }
        false
    }
}
