//! What a camera sees of a mesh: the depth of its front at every pixel.

use crate::{camera::Pinhole, point_cloud::Mesh};
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

    /// Rasterises a triangle if it faces the camera: pixels whose centres it holds, 1/depth being linear in the image.
    fn fill(&mut self, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        // With y down a triangle that is counter-clockwise seen from the camera has negative area.
        if !(area < 0.0) || a.z <= 0.0 || b.z <= 0.0 || c.z <= 0.0 {
            return;
        }
        let low = |a: f32, b: f32, c: f32| libm::ceilf(a.min(b).min(c)).max(0.0) as usize;
        let high =
            |a: f32, b: f32, c: f32, n: usize| (libm::floorf(a.max(b).max(c)) + 1.0).clamp(0.0, n as f32) as usize;
        let inverse = [1.0 / a.z, 1.0 / b.z, 1.0 / c.z];
        for y in low(a.y, b.y, c.y)..high(a.y, b.y, c.y, self.height) {
            for x in low(a.x, b.x, c.x)..high(a.x, b.x, c.x, self.width) {
                let (u, v) = (x as f32, y as f32);
                let edge = |p: Vec3, q: Vec3| (q.x - p.x) * (v - p.y) - (u - p.x) * (q.y - p.y);
                let (wa, wb, wc) = (edge(b, c), edge(c, a), edge(a, b));
                if wa <= 0.0 && wb <= 0.0 && wc <= 0.0 {
                    let depth = (wa * inverse[0] + wb * inverse[1] + wc * inverse[2]) / area;
                    let i = y * self.width + x;
                    self.inverse[i] = self.inverse[i].max(depth);
                }
            }
        }
    }
}
