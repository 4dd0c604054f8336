//! Rasterises a mesh: the depth of its front at every pixel ([`Raster`]), and all depths at which pixel rays cross it
//! ([`Crossings`]), which are the hull's intervals of §4.1.

mod between;

use crate::{
    camera::Pinhole,
    math::{from_ordered, max, min, ordered},
    point_cloud::Mesh,
    sort,
};
use alloc::vec::Vec;
use between::{Between, spanned};
use glam::Vec3;

/// A depth buffer: the inverse depth of the nearest front face at every pixel. Reused for all views, so that its memory
/// is allocated once.
#[derive(Debug, Default)]
pub struct Raster {
    /// Pixel and depth of every vertex.
    projected: Vec<Vec3>,
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Inverse depth per pixel; zero where the mesh is not visible.
    pub inverse: Vec<f32>,
}

impl Raster {
    /// Rasterises the front faces of the mesh.
    pub fn render(&mut self, mesh: &Mesh, camera: &Pinhole) {
        self.projected.clear();
        self.projected.extend(mesh.positions.iter().map(|&p| camera.project(p)));
        (self.width, self.height) = (camera.width as usize, camera.height as usize);
        self.inverse.clear();
        self.inverse.resize(self.width * self.height, 0.0);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|i| self.projected[i as usize]);
            draw_front(corners, self.width, self.height, &mut self.inverse);
        }
    }

    /// Whether the camera sees a point that projects to `pixel` (position and depth): it lies in the picture and at
    /// most `tolerance` behind the front of the mesh.
    pub fn sees(&self, pixel: Vec3, tolerance: f32) -> bool {
        let (x, y) = (libm::roundf(pixel.x), libm::roundf(pixel.y));
        if !(x >= 0.0 && y >= 0.0 && x < self.width as f32 && y < self.height as f32 && pixel.z > 0.0) {
            return false;
        }
        self.inverse[y as usize * self.width + x as usize] * (pixel.z - tolerance) <= 1.0
    }
}

/// Draws a triangle into a depth buffer of inverse depths, if it faces the camera. `corners` are positions in the
/// buffer, in pixels, and depths.
#[inline]
pub(crate) fn draw_front(corners: [Vec3; 3], width: usize, height: usize, inverse: &mut [f32]) {
    // Half of the triangles of a closed mesh face away. Nothing else of them need be computed.
    if !(area(corners) < 0.0) {
        return;
    }
    cover(corners, width, height, |x, y, z, _| {
        let nearest = &mut inverse[y * width + x];
        *nearest = max(z, *nearest);
    });
}

/// The part of a pixel's ray inside a closed mesh, as depths along the optical axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Where the ray enters.
    pub near: f32,
    /// Where it leaves.
    pub far: f32,
}

/// All crossings of a camera's pixel rays with a mesh. Reused for all views, so that its memory is allocated once.
#[derive(Debug, Default)]
pub struct Crossings {
    /// Pixel and depth of every vertex.
    projected: Vec<Vec3>,
    between: Between,
    /// Pixel, inverse depth and side (true for a front face) of each crossing, in the order of the triangles.
    found: Vec<(u32, f32, bool)>,
    /// For each pixel, where its next crossing is written.
    next: Vec<u32>,
    /// For each pixel, the index of its first crossing; then the total number.
    starts: Vec<u32>,
    /// The crossings of one pixel after the other. Each is the inverted ordered integer of the inverse depth, followed
    /// by a last bit that is set where the ray leaves the mesh. In ascending order the nearest crossing comes first.
    crossings: Vec<u64>,
}

impl Crossings {
    /// Finds the crossings of all pixels' rays.
    pub fn find(&mut self, mesh: &Mesh, camera: &Pinhole) {
        let Self { projected, between, found, next, starts, crossings } = self;
        projected.clear();
        projected.extend(mesh.positions.iter().map(|&p| camera.project(p)));
        let (w, h) = (camera.width as usize, camera.height as usize);
        starts.clear();
        starts.resize(w * h + 1, 0);
        found.clear();
        between.set(projected.iter().copied(), w, h);
        between.for_each(mesh, |triangle| {
            cover(triangle.map(|i| projected[i as usize]), w, h, |x, y, z, front| {
                let pixel = y * w + x;
                starts[pixel + 1] += 1;
                found.push((pixel as u32, z, front));
            });
        });
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

    /// Calls `f` with the depths at which a pixel's ray enters and leaves the mesh, nearest interval first.
    pub fn intervals(&mut self, pixel: usize, mut f: impl FnMut(Interval)) {
        let crossings = &mut self.crossings[self.starts[pixel] as usize..self.starts[pixel + 1] as usize];
        sort::numbers(crossings);
        // A ray through an edge may cross both adjacent triangles or neither. Therefore only changes of side count.
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

/// Twice the area of a triangle in the image. Because y points down, a triangle that is counter-clockwise as seen from the
/// camera, which is a front face, has a negative area.
#[inline(always)]
pub(crate) fn area([a, b, c]: [Vec3; 3]) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y)
}

/// Calls `f` for each pixel whose centre a triangle covers, with the triangle's inverse depth there, which is linear in
/// the image, and whether the triangle faces the camera.
#[inline(always)]
pub(crate) fn cover([a, b, c]: [Vec3; 3], width: usize, height: usize, mut f: impl FnMut(usize, usize, f32, bool)) {
    let area = area([a, b, c]);
    if area == 0.0 || !area.is_finite() || a.z <= 0.0 || b.z <= 0.0 || c.z <= 0.0 {
        return;
    }
    let [x0, x1] = spanned(a.x, b.x, c.x, width);
    let [y0, y1] = spanned(a.y, b.y, c.y, height);
    // In a fine mesh most triangles cover no pixel centre.
    if x0 >= x1 || y0 >= y1 {
        return;
    }
    let inverse = [1.0 / a.z / area, 1.0 / b.z / area, 1.0 / c.z / area];
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

#[cfg(test)]
mod tests;
