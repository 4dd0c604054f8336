//! What a camera sees of a mesh: the depth of its front at every pixel.

use crate::{
    camera::Pinhole,
    math::{from_ordered, max, min, ordered},
    point_cloud::Mesh,
};
use alloc::vec::Vec;
use glam::Vec3;

/// Inverse depths of the surface nearest to a camera. Kept from view to view so that its memory is asked for once.
#[derive(Debug, Default)]
pub struct Raster {
    /// Pixel and depth of every vertex.
    projected: Vec<Vec3>,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Inverse depth, zero where the camera sees past the mesh.
    pub inverse: Vec<f32>,
}

impl Raster {
    /// Rasterises the front of the mesh.
    pub fn render(&mut self, mesh: &Mesh, camera: &Pinhole) {
        self.projected.clear();
        self.projected.extend(mesh.positions.iter().map(|&p| camera.project(p)));
        (self.width, self.height) = (camera.width as usize, camera.height as usize);
        self.inverse.clear();
        self.inverse.resize(self.width * self.height, 0.0);
        for triangle in &mesh.triangles {
            self.fill(triangle.map(|i| self.projected[i as usize]));
        }
    }

    /// Whether the camera sees a point that projects to `pixel` (with its depth), being at most `tolerance` behind
    /// the mesh's front.
    pub fn sees(&self, pixel: Vec3, tolerance: f32) -> bool {
        let (x, y) = (libm::roundf(pixel.x), libm::roundf(pixel.y));
        if !(x >= 0.0 && y >= 0.0 && x < self.width as f32 && y < self.height as f32 && pixel.z > 0.0) {
            return false;
        }
        self.inverse[y as usize * self.width + x as usize] * (pixel.z - tolerance) <= 1.0
    }

    /// Keeps a triangle's depths where it is the nearest front.
    fn fill(&mut self, corners: [Vec3; 3]) {
        let (width, inverse) = (self.width, &mut self.inverse);
        cover(corners, self.width, self.height, |x, y, z, front| {
            if front {
                let nearest = &mut inverse[y * width + x];
                *nearest = max(z, *nearest);
            }
        });
    }
}

/// A piece of a pixel's ray inside a closed mesh, as depths along the optical axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Where the ray enters.
    pub near: f32,
    /// Where it leaves.
    pub far: f32,
}

/// Every crossing of a camera's pixel rays with a mesh. Kept from view to view so that its memory is asked for once.
#[derive(Debug, Default)]
pub struct Crossings {
    /// Pixel and depth of every vertex.
    projected: Vec<Vec3>,
    /// Pixel, inverse depth and side of each crossing, in the mesh's order.
    found: Vec<(u32, f32, bool)>,
    /// Per pixel where its next crossing goes.
    next: Vec<u32>,
    /// Per pixel the first of its crossings, then one end.
    starts: Vec<u32>,
    /// Inverse depth as an ordered integer, its bits inverted, and in the last bit whether the ray leaves the mesh there:
    /// in rising order the nearest comes first.
    crossings: Vec<u64>,
}

impl Crossings {
    /// Finds the crossings of all pixels' rays.
    pub fn find(&mut self, mesh: &Mesh, camera: &Pinhole) {
        let Self { projected, found, next, starts, crossings } = self;
        projected.clear();
        projected.extend(mesh.positions.iter().map(|&p| camera.project(p)));
        let (w, h) = (camera.width as usize, camera.height as usize);
        starts.clear();
        starts.resize(w * h + 1, 0);
        found.clear();
        for triangle in &mesh.triangles {
            cover(triangle.map(|i| projected[i as usize]), w, h, |x, y, z, front| {
                let pixel = y * w + x;
                starts[pixel + 1] += 1;
                found.push((pixel as u32, z, front));
            });
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        next.clone_from(starts);
        crossings.clear();
        crossings.resize(found.len(), 0);
        for &(pixel, z, front) in found.iter() {
            let next = &mut next[pixel as usize];
            crossings[*next as usize] = u64::from(!ordered(z)) << 1 | u64::from(!front);
            *next += 1;
        }
    }

    /// Depths at which a pixel's ray enters and leaves the mesh, nearest first.
    pub fn intervals(&mut self, pixel: usize, mut f: impl FnMut(Interval)) {
        let crossings = &mut self.crossings[self.starts[pixel] as usize..self.starts[pixel + 1] as usize];
        crossings.sort_unstable();
        // A ray through an edge may cross both its triangles, or neither: only changes of side count.
        let mut entered = None;
        for &mut key in crossings {
            let z = from_ordered(!((key >> 1) as u32));
            match (key & 1 == 0, entered) {
                (true, None) => entered = Some(1.0 / z),
                (false, Some(near)) => {
                    f(Interval { near, far: 1.0 / z });
                    entered = None;
                }
                _ => {}
            }
        }
    }
}

/// Calls `f` with the pixels whose centres a triangle covers, its inverse depth there (which is linear in the image)
/// and whether it faces the camera.
#[inline(always)]
pub(crate) fn cover([a, b, c]: [Vec3; 3], width: usize, height: usize, mut f: impl FnMut(usize, usize, f32, bool)) {
    let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    if area == 0.0 || !area.is_finite() || a.z <= 0.0 || b.z <= 0.0 || c.z <= 0.0 {
        return;
    }
    // Truncation is floor here: negative values are clamped first.
    let high = |a: f32, b: f32, c: f32, n: usize| (max(max(max(a, b), c) + 1.0, 0.0) as i32).min(n as i32);
    let low = |a: f32, b: f32, c: f32| {
        let v = max(min(min(a, b), c), 0.0);
        let floor = v as i32;
        floor + i32::from(floor as f32 != v)
    };
    let (x0, x1) = (low(a.x, b.x, c.x), high(a.x, b.x, c.x, width));
    let (y0, y1) = (low(a.y, b.y, c.y), high(a.y, b.y, c.y, height));
    // Most triangles of a fine mesh lie between the pixels' centres.
    if x0 >= x1 || y0 >= y1 {
        return;
    }
    let inverse = [1.0 / a.z / area, 1.0 / b.z / area, 1.0 / c.z / area];
    // With y down a triangle that is counter-clockwise seen from the camera has negative area.
    let front = area < 0.0;
    for y in y0..y1 {
        for x in x0..x1 {
            let (u, v) = (x as f32, y as f32);
            let edge = |p: Vec3, q: Vec3| (q.x - p.x) * (v - p.y) - (u - p.x) * (q.y - p.y);
            let (wa, wb, wc) = (edge(b, c), edge(c, a), edge(a, b));
            let inside = if front { max(max(wa, wb), wc) <= 0.0 } else { min(min(wa, wb), wc) >= 0.0 };
            if inside {
                f(x as usize, y as usize, wa * inverse[0] + wb * inverse[1] + wc * inverse[2], front);
            }
        }
    }
}
