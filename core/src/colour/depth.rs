//! What a camera sees of a mesh: a depth buffer, and how far each pixel is from the nearest occlusion step.

use crate::{
    camera::Pinhole,
    math::{max, min},
    point_cloud::Mesh,
    raster::cover,
    workspace::Workspace,
};
use alloc::vec::Vec;
use glam::{Vec2, Vec3};

/// A depth step of more footprints than this between neighbouring pixels hides something behind it; less is slope.
const STEP_FOOTPRINTS: f32 = 4.0;
/// Distances to steps are told apart up to this many pixels.
const MAX_BORDER: u8 = 4;

/// Depths of the surface nearest to a camera, over the part of its picture that the mesh covers. Kept from view to
/// view so that its memory is asked for once.
#[derive(Debug, Default)]
pub(super) struct DepthBuffer {
    /// Pixel and depth of every vertex.
    projected: Vec<Vec3>,
    /// First column and row covered.
    x: i32,
    y: i32,
    width: i32,
    height: i32,
    /// Inverse depth, zero where the camera sees past the mesh.
    inverse: Vec<f32>,
    /// Pixels to the nearest step or background, zero on background.
    border: Vec<u8>,
}

impl DepthBuffer {
    /// In memory that has been kept.
    pub(super) fn with_workspace(workspace: &mut Workspace) -> Self {
        Self { projected: workspace.take(), inverse: workspace.take(), border: workspace.take(), ..Self::default() }
    }

    /// Hands its memory back.
    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.projected);
        workspace.recycle(self.inverse);
        workspace.recycle(self.border);
    }

    /// Rasterises the front of the mesh.
    pub(super) fn render(&mut self, mesh: &Mesh, camera: &Pinhole) {
        self.projected.clear();
        self.projected.extend(mesh.positions.iter().map(|&p| camera.project(p)));
        self.frame(camera);
        self.inverse.clear();
        self.inverse.resize((self.width * self.height) as usize, 0.0);
        let first = Vec3::new(self.x as f32, self.y as f32, 0.0);
        let (width, height) = (self.width as usize, self.height as usize);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|i| self.projected[i as usize] - first);
            cover(corners, width, height, |x, y, z, front| {
                if front {
                    let nearest = &mut self.inverse[y * width + x];
                    *nearest = max(z, *nearest);
                }
            });
        }
        self.measure_border(camera);
    }

    /// Pixel and depth of a vertex.
    pub(super) fn projected(&self, vertex: usize) -> Vec3 {
        self.projected[vertex]
    }

    /// The pixels to the nearest occlusion step if the camera sees the surface at this pixel and depth. `gradient` is
    /// the surface's change of inverse depth a pixel, `tolerance` the depth by which it may seem hidden all the same.
    pub(super) fn visible(&self, pixel: Vec3, gradient: Vec2, tolerance: f32) -> Option<f32> {
        let (u, v) = (pixel.x - self.x as f32, pixel.y - self.y as f32);
        // Written so that NaN fails too.
        if !(pixel.z > 0.0 && u >= 0.0 && v >= 0.0 && u < (self.width - 1) as f32 && v < (self.height - 1) as f32) {
            return None;
        }
        let i = v as usize * self.width as usize + u as usize;
        let corners = [i, i + 1, i + self.width as usize, i + self.width as usize + 1];
        let (fx, fy) = (u - libm::floorf(u), v - libm::floorf(v));
        let limit = 1.0 / (pixel.z - tolerance);
        for (k, &corner) in corners.iter().enumerate() {
            let offset = Vec2::new((k % 2) as f32 - fx, (k / 2) as f32 - fy);
            if self.inverse[corner] > limit + gradient.dot(offset) {
                return None;
            }
        }
        // Bilinear, so that weights that follow from it are smooth over the surface.
        let [a, b, c, d] = corners.map(|c| f32::from(self.border[c]));
        let (top, bottom) = (a + (b - a) * fx, c + (d - c) * fx);
        // Half a pixel beyond the last pixel's centre lies the step.
        Some(top + (bottom - top) * fy - 0.5)
    }

    /// Bounds of the projected vertices within the picture, a pixel wider so that background surrounds the mesh.
    fn frame(&mut self, camera: &Pinhole) {
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for p in self.projected.iter().filter(|p| p.z > 0.0) {
            low = low.min(p.truncate());
            high = high.max(p.truncate());
        }
        let clamp = |v: f32, n: u32| libm::floorf(v).clamp(0.0, n as f32) as i32;
        (self.x, self.y) = (clamp(low.x - 1.0, camera.width), clamp(low.y - 1.0, camera.height));
        self.width = (clamp(high.x + 3.0, camera.width) - self.x).max(0);
        self.height = (clamp(high.y + 3.0, camera.height) - self.y).max(0);
    }

    /// Chessboard distance of every pixel to the nearest step, by two sweeps.
    fn measure_border(&mut self, camera: &Pinhole) {
        let (w, h) = (self.width as usize, self.height as usize);
        self.border.clear();
        self.border.resize(w * h, 0);
        let step = |a: f32, b: f32| {
            // |1/a - 1/b| > STEP_FOOTPRINTS · depth / focal, without dividing.
            let (near, far) = (max(a, b), min(a, b));
            near - far > STEP_FOOTPRINTS / camera.focal * near
        };
        for y in 1..h.max(1) - 1 {
            for x in 1..w.max(1) - 1 {
                let i = y * w + x;
                let z = self.inverse[i];
                if z > 0.0 {
                    let edge = [i - 1, i + 1, i - w, i + w].into_iter().any(|j| step(z, self.inverse[j]));
                    self.border[i] = if edge { 1 } else { MAX_BORDER };
                }
            }
        }
        let spread = |border: &mut [u8], i: usize, from: [usize; 4]| {
            let nearest = from.into_iter().map(|j| border[j]).min().unwrap_or(MAX_BORDER);
            border[i] = border[i].min(nearest + 1);
        };
        for y in 1..h.max(1) - 1 {
            for x in 1..w - 1 {
                let i = y * w + x;
                spread(&mut self.border, i, [i - w - 1, i - w, i - w + 1, i - 1]);
            }
        }
        for y in (1..h.max(1) - 1).rev() {
            for x in (1..w - 1).rev() {
                let i = y * w + x;
                spread(&mut self.border, i, [i + w - 1, i + w, i + w + 1, i + 1]);
            }
        }
    }
}
