//! The depth range in which each pixel is searched (§4.1): the hull's intervals, or a band around a guide surface.

use super::level::PyramidLevel;
use crate::raster::{Crossings, Interval, Raster};
use alloc::vec::Vec;

/// Depth intervals of a view's pixels, and the guide surface that the windows follow. Reused for all views, so that its
/// memory is allocated once.
#[derive(Debug, Clone, Default)]
pub struct SearchRange {
    /// For each pixel, the index of its first interval; then the number of intervals.
    starts: Vec<u32>,
    intervals: Vec<Interval>,
    /// Depth of the guide surface per pixel; 0 where nothing is searched.
    pub guide: Vec<f32>,
}

impl SearchRange {
    /// Sets the range to the intervals of the silhouette pixels' rays inside the hull. They are given by the crossings
    /// of the rays with the hull's mesh. The guide surface is the hull's front.
    pub fn set_in_hull(&mut self, level: &PyramidLevel, crossings: &mut Crossings) {
        self.clear();
        for pixel in 0..level.inside.len() {
            let front = if level.inside[pixel] > 0 { self.add_hull(pixel, crossings) } else { 0.0 };
            self.end_pixel(front);
        }
    }

    /// Sets the range to a band around the surface that the camera sees. `band` is its half width in scene units along
    /// the optical axis. With crossings of the hull's mesh, the silhouette's pixels in which the camera sees no surface get the
    /// intervals inside the hull.
    pub fn set_around_surface(
        &mut self,
        level: &PyramidLevel,
        surface: &Raster,
        band: f32,
        mut crossings: Option<&mut Crossings>,
    ) {
        self.clear();
        for (pixel, (&inside, &inverse)) in level.inside.iter().zip(&surface.inverse).enumerate() {
            let front = if inside <= 0 {
                0.0
            } else if inverse > 0.0 {
                let depth = 1.0 / inverse;
                self.intervals.push(Interval { near: depth - band, far: depth + band });
                depth
            } else {
                crossings.as_deref_mut().map_or(0.0, |crossings| self.add_hull(pixel, crossings))
            };
            self.end_pixel(front);
        }
    }

    /// Adds the intervals of a pixel's ray inside the hull, and returns the depth of the hull's front, or 0 where there is none.
    fn add_hull(&mut self, pixel: usize, crossings: &mut Crossings) -> f32 {
        let first = self.intervals.len();
        crossings.intervals(pixel, |interval| self.intervals.push(interval));
        self.intervals.get(first).map_or(0.0, |interval| interval.near)
    }

    /// Ends the list of a pixel's intervals. `guide` is the depth of the guide surface there.
    fn end_pixel(&mut self, guide: f32) {
        self.guide.push(guide);
        self.starts.push(self.intervals.len() as u32);
    }

    fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
        self.intervals.clear();
        self.guide.clear();
    }

    /// The intervals of a pixel, nearest first.
    #[inline]
    pub fn of(&self, pixel: usize) -> &[Interval] {
        &self.intervals[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }
}
