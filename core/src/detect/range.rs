//! Where each pixel's search runs (§4.1): inside the hull, or in a band round a surface found before.

use super::level::Level;
use crate::{hull::Interval, point_cloud::Mesh, raster::Crossings};
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
    /// The pieces of the silhouette pixels' rays inside the hull, given by its mesh; the guide is the hull's front.
    pub fn in_hull(level: &Level, hull: &Mesh) -> Self {
        let pixels = level.inside.len();
        let mut crossings = Crossings::new(hull, &level.camera);
        let mut range = Self { starts: vec![0], intervals: Vec::new(), guide: vec![0.0; pixels] };
        for pixel in 0..pixels {
            if level.inside[pixel] > 0 {
                crossings.intervals(pixel, |near, far| range.intervals.push(Interval { near, far }));
                let first = range.starts[pixel] as usize;
                range.guide[pixel] = range.intervals.get(first).map_or(0.0, |i| i.near);
            }
            range.starts.push(range.intervals.len() as u32);
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
