//! Where each pixel's search runs (§4.1): inside the hull, or in a band round a surface found before.

use super::level::Level;
use crate::hull::{Interval, VisualHull};
use alloc::{vec, vec::Vec};

/// Depth intervals of a view's pixels and the surface that the windows follow.
#[derive(Debug, Clone, Default)]
pub struct SearchRange {
    /// Per pixel the first of its intervals, then one end.
    starts: Vec<u32>,
    intervals: Vec<Interval>,
    /// Depth of the guide surface per pixel, 0 where there is nothing to search.
    pub guide: Vec<f32>,
}

impl SearchRange {
    /// The hull's intervals along the rays of the silhouette's pixels; the guide is the hull's front.
    pub fn in_hull(level: &Level, hull: &VisualHull) -> Self {
        let (w, h) = (level.camera.width, level.camera.height);
        let mut range = Self { starts: vec![0], ..Self::default() };
        let mut found = Vec::new();
        for y in 0..h {
            for x in 0..w {
                found.clear();
                if level.inside[(y * w + x) as usize] > 0 {
                    hull.intervals(level.camera.centre, level.camera.ray(x as f32, y as f32), &mut found);
                    range.intervals.extend_from_slice(&found);
                }
                range.guide.push(found.first().map_or(0.0, |i| i.near));
                range.starts.push(range.intervals.len() as u32);
            }
        }
        range
    }

    /// A band of half width `band` (scene units along the ray) round a depth map, 0 where it sees nothing.
    pub fn round_surface(level: &Level, depth: Vec<f32>, band: f32) -> Self {
        let mut range = Self { starts: vec![0], intervals: Vec::new(), guide: depth };
        for (i, z) in range.guide.iter_mut().enumerate() {
            if level.inside[i] <= 0 {
                *z = 0.0;
            }
            if *z > 0.0 {
                range.intervals.push(Interval { near: *z - band, far: *z + band });
            }
            range.starts.push(range.intervals.len() as u32);
        }
        range
    }

    /// A pixel's intervals, nearest first.
    #[inline]
    pub fn of(&self, pixel: usize) -> &[Interval] {
        &self.intervals[self.starts[pixel] as usize..self.starts[pixel + 1] as usize]
    }
}
