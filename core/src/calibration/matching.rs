//! Matches the corners of each view in its neighbours. The hull tells where to look and how the window is warped.

use super::{
    instant::{Guide, Instant},
    model::Model,
    patch,
    track::{Observation, Source, Track, is_held_out},
};
use crate::{
    camera::Pinhole,
    error::Result,
    executor::Executor,
    progress::{self, Progress},
    raster::Raster,
    rig::Rig,
    stage::Stage,
};
use alloc::{vec, vec::Vec};
use core::sync::atomic::{AtomicU32, Ordering};
use glam::{DVec2, DVec3, Mat2, Vec2, Vec3};

/// Neighbours in which each view is matched.
const NEIGHBOURS: usize = 4;
/// Distance in pixels at which the hull's depth is compared to find how a window is warped.
const AROUND: usize = 3;
/// The depths on both sides of a corner may deviate from a plane by this many footprints.
const BENT: f32 = 3.0;
/// A neighbour sees a corner if the hull lies less than this many footprints before it.
const HIDDEN: f32 = 8.0;
/// Bounds of how much larger or smaller a window may appear in a neighbour, as an area.
const AREAS: [f32; 2] = [0.35, 2.8];
/// Standard deviation of a corner's own position in pixels. Matches are relative to it.
pub(super) const OWN_SIGMA: f64 = 0.08;
/// A comparison of the brightness of two views: the places of both cameras, and the second over the first.
pub(super) type Brightness = (u16, u16, f32);

/// The tracks of one frame, in the order of the views and of their corners.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn tracks(
    rig: &Rig,
    instant: &Instant,
    models: &[Model],
    guide: &Guide,
    reach: usize,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<(Vec<Track>, Vec<Brightness>)> {
    let footprint = guide.footprint;
    let pinholes: Vec<Pinhole> = models.iter().map(Model::pinhole).collect();
    let rasters = executor.map(models.len(), |i| {
        let mut raster = Raster::default();
        raster.render(&guide.mesh, &pinholes[i]);
        raster
    });
    let done = AtomicU32::new(0);
    let found = executor.map(models.len(), |view| {
        progress::step(progress, Stage::Detect, done.load(Ordering::Relaxed), models.len() as u32)?;
        let (mut tracks, mut brightness) = (Vec::new(), Vec::new());
        for (number, &corner) in instant.pictures[view].corners.iter().enumerate() {
            let Some(around) = Surroundings::new(&rasters[view], &pinholes[view], corner, footprint) else { continue };
            let own = Observation {
                camera: view as u16,
                pixel: models[view].real_of_ideal(DVec2::new(f64::from(corner[0]), f64::from(corner[1]))),
                sigma: OWN_SIGMA,
            };
            let mut observations = vec![own];
            let there = |&&other: &&u16| instant.pictures[usize::from(other)].is_there;
            for &other in rig.neighbours(view).iter().filter(there).take(NEIGHBOURS) {
                let there = other as usize;
                let Some((expected, affine)) = around.seen_by(&pinholes[there], &rasters[there], footprint) else {
                    continue;
                };
                let pictures = [view, there].map(|i| &instant.pictures[i].smooth);
                if let Some(found) = patch::find(pictures, corner, expected, affine, reach) {
                    let pixel = models[there].real_of_ideal(found.pixel.as_dvec2());
                    observations.push(Observation { camera: other, pixel, sigma: found.sigma });
                    brightness.push((view as u16, other, found.gain));
                }
            }
            let held_out = is_held_out(number);
            let mut track = Track { observations, point: DVec3::ZERO, source: Source::Texture, held_out };
            if track.observations.len() > 1 && track.triangulate(models, 1e3) {
                tracks.push(track);
            }
        }
        done.fetch_add(1, Ordering::Relaxed);
        Ok((tracks, brightness))
    });
    let (mut tracks, mut brightness) = (Vec::new(), Vec::new());
    for found in found {
        let (of_view, compared) = found?;
        tracks.extend(of_view);
        brightness.extend(compared);
    }
    Ok((tracks, brightness))
}

/// The hull at a corner: the point that it shows, and how far the surface goes on to the right and down.
struct Surroundings {
    point: Vec3,
    right: Vec3,
    down: Vec3,
}

impl Surroundings {
    /// `None` where the hull is not seen or bends sharply.
    fn new(raster: &Raster, camera: &Pinhole, [x, y]: [u16; 2], footprint: f32) -> Option<Self> {
        let (x, y) = (usize::from(x), usize::from(y));
        let depth = |x: usize, y: usize| {
            let inverse = raster.inverse[y * raster.width + x];
            (inverse > 0.0).then(|| 1.0 / inverse)
        };
        let point = |x: usize, y: usize| Some(camera.unproject(x as f32, y as f32, depth(x, y)?));
        let middle = depth(x, y)?;
        let bends = |a: Option<f32>, b: Option<f32>| Some((a? + b? - 2.0 * middle).abs() > BENT * footprint);
        if bends(depth(x - AROUND, y), depth(x + AROUND, y))? || bends(depth(x, y - AROUND), depth(x, y + AROUND))? {
            return None;
        }
        let step = 0.5 / AROUND as f32;
        Some(Self {
            point: point(x, y)?,
            right: (point(x + AROUND, y)? - point(x - AROUND, y)?) * step,
            down: (point(x, y + AROUND)? - point(x, y - AROUND)?) * step,
        })
    }

    /// Where another camera sees the point, and its map of offsets in pixels; `None` if it does not see it well.
    fn seen_by(&self, camera: &Pinhole, raster: &Raster, footprint: f32) -> Option<(Vec2, Mat2)> {
        let at = camera.project(self.point);
        if !raster.sees(at, HIDDEN * footprint) {
            return None;
        }
        let ahead = |by: Vec3| 0.5 * (camera.project(self.point + by) - camera.project(self.point - by)).truncate();
        let affine = Mat2::from_cols(ahead(self.right), ahead(self.down));
        let area = affine.determinant();
        (area > AREAS[0] && area < AREAS[1]).then_some((at.truncate(), affine))
    }
}
