//! Rays of a view through the hull of the other views.

use super::super::carver::Carver;
use core::ops::ControlFlow;
use glam::Vec3;

/// Largest number of a part's pixels whose rays are followed, and the share of them that must meet the hull of the other
/// views.
const RAYS: usize = 48;
const MIN_SHARE: f32 = 0.9;
/// Shortest piece of a ray inside the hull of the other views that counts, and the step along a ray, in pixels of footprint.
const MIN_LENGTH: f32 = 12.0;
const STEP: f32 = 4.0;
/// Smallest number of silhouettes that must contain a place of a ray.
const MIN_SUPPORT: u32 = 3;

/// Rays of a view through the hull of the other views.
pub(super) struct Rays<'a> {
    /// The views that carve the hull, and the view's place among them.
    pub carvers: &'a [Carver],
    pub own: usize,
    /// Bounds of the hull, and the size of a pixel there, in scene units.
    pub bounds: (Vec3, Vec3),
    pub footprint: f32,
}

impl Rays<'_> {
    /// First and last column and row of the part of the picture in which the hull may lie.
    pub fn part_of_picture(&self, w: usize, h: usize) -> [[usize; 2]; 2] {
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
    pub fn meet(&self, part: &[u32], width: usize) -> bool {
        let every = part.len().div_ceil(RAYS);
        let followed = part.len().div_ceil(every);
        let met = part.iter().step_by(every).filter(|&&i| {
            let i = i as usize;
            self.meets((i % width) as f32, (i / width) as f32)
        });
        met.count() as f32 >= MIN_SHARE * followed as f32
    }

    /// Whether a pixel's ray meets the hull of the other views in a piece that is long enough.
    pub fn meets(&self, x: f32, y: f32) -> bool {
        let mut length = 0.0;
        self.walk(x, y, STEP, |place| {
            length = if place.is_some() { length + STEP } else { 0.0 };
            if length >= MIN_LENGTH { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
        .is_break()
    }

    /// Visits the places along a pixel's ray, `step` pixels of footprint apart: the depths of those inside the hull of the
    /// other views, and `None` for the others.
    pub fn walk(
        &self,
        x: f32,
        y: f32,
        step: f32,
        mut visit: impl FnMut(Option<f32>) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let camera = &self.carvers[self.own].camera;
        let ray = camera.ray(x, y);
        let unit = 1.0 / ray.length();
        let (low, high) = self.bounds;
        let (middle, radius) = ((low + high) * 0.5, (high - low).length() * 0.5);
        let from = (middle - camera.centre).length();
        let step = step * self.footprint * unit;
        let (mut t, end) = ((from - radius).max(0.0) * unit, (from + radius) * unit);
        let mut excluding = self.own;
        while t < end {
            let depth = t;
            let p = camera.centre + ray * depth;
            t += step;
            // The view that excluded the last place will mostly exclude this one as well.
            if excluding != self.own && self.carvers[excluding].pixels(p).is_some_and(|d| d < 0.0) {
                visit(None)?;
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
            visit((excluded.is_none() && support >= MIN_SUPPORT).then_some(depth))?;
        }
        ControlFlow::Continue(())
    }
}
