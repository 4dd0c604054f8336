//! Where each pixel's search runs (§4.1): inside the hull, or in a band around a surface found before.

use super::level::PyramidLevel;
use crate::raster::{Crossings, Interval, Raster};
use alloc::vec::Vec;

/// Depth intervals of a view's pixels and the surface that the windows follow. Kept from view to view so that its memory
/// is asked for once.
#[derive(Debug, Clone, Default)]
pub struct SearchRange {
    /// Per pixel the first of its intervals, then one end.
    starts: Vec<u32>,
    intervals: Vec<Interval>,
    /// Depth of the guide surface per pixel, 0 where there is nothing to search.
    pub guide: Vec<f32>,
}

impl SearchRange {
    /// Becomes the pieces of the silhouette pixels' rays inside the hull, given by its mesh's crossings with them; the
    /// guide is the hull's front.
    pub fn set_in_hull(&mut self, level: &PyramidLevel, crossings: &mut Crossings) {
        self.clear();
        for pixel in 0..level.inside.len() {
            let mut front = 0.0;
            if level.inside[pixel] > 0 {
                let first = self.intervals.len();
                crossings.intervals(pixel, |interval| self.intervals.push(interval));
                front = self.intervals.get(first).map_or(0.0, |i| i.near);
            }
            self.guide.push(front);
            self.starts.push(self.intervals.len() as u32);
        }
    }

    /// Becomes a band of half width `band` (scene units along the ray) round the surface that a camera sees.
    pub fn set_around_surface(&mut self, level: &PyramidLevel, surface: &Raster, band: f32) {
        self.clear();
        for (&inside, &inverse) in level.inside.iter().zip(&surface.inverse) {
            let depth = if inside > 0 && inverse > 0.0 { 1.0 / inverse } else { 0.0 };
            if depth > 0.0 {
                self.intervals.push(Interval { near: depth - band, far: depth + band });
            }
            self.guide.push(depth);
            self.starts.push(self.intervals.len() as u32);
        }
    }

    fn clear(&mut self) {
        self.starts.clear();
        self.starts.push(0);
        self.intervals.clear();
        self.guide.clear();
    }

    /// A pixel's intervals, nearest first.
    #[inline]
    pub fn of(&self, pixel: usize) -> &[Interval] {
        &self.intervals[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }
}
