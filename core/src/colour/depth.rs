//! A depth buffer of a mesh with the distance of each pixel to the nearest depth step, for the visibility test of §7.

use crate::{
    camera::Pinhole,
    chessboard,
    math::{max, min},
    point_cloud::Mesh,
    raster::draw_front,
    silhouette::{Silhouette, Uncovered},
    workspace::Workspace,
};
use alloc::vec::Vec;
use glam::{Vec2, Vec3};

/// A depth difference between neighbouring pixels of more than this many footprints is an occlusion. Smaller
/// differences are due to slope.
const STEP_FOOTPRINTS: f32 = 4.0;
/// Largest distance to a depth step that is measured, in pixels.
const MAX_BORDER: u8 = 4;

/// Inverse depths of the nearest front faces, over the part of the picture that the mesh covers. Reused for other views,
/// so that its memory is allocated once.
///
/// Unlike [`crate::raster::Raster`] it is cropped to the mesh, because its distances to depth steps are measured over
/// all its pixels. Both draw triangles by [`draw_front`].
#[derive(Debug, Default)]
pub(super) struct DepthBuffer {
    /// First column and row, width and height of the covered part, in pixels.
    x: i32,
    y: i32,
    width: i32,
    height: i32,
    /// Inverse depth per pixel; zero where the mesh is not visible.
    inverse: Vec<f32>,
    /// Chessboard distance in pixels to the nearest depth step or background; zero on background.
    border: Vec<u8>,
}

impl DepthBuffer {
    /// An empty buffer that uses memory of the workspace.
    pub(super) fn with_workspace(workspace: &mut Workspace) -> Self {
        Self { inverse: workspace.take(), border: workspace.take(), ..Self::default() }
    }

    /// Returns its memory to the workspace.
    pub(super) fn recycle_into(self, workspace: &mut Workspace) {
        workspace.recycle(self.inverse);
        workspace.recycle(self.border);
    }

    /// Rasterises the front faces of the mesh. `projected` is overwritten by the pixel and depth of every vertex.
    pub(super) fn render(&mut self, mesh: &Mesh, camera: &Pinhole, projected: &mut Vec<Vec3>) {
        projected.clear();
        projected.extend(mesh.positions.iter().map(|&p| camera.project(p)));
        self.frame(camera, projected);
        self.inverse.clear();
        self.inverse.resize((self.width * self.height) as usize, 0.0);
        let first = Vec3::new(self.x as f32, self.y as f32, 0.0);
        let (width, height) = (self.width as usize, self.height as usize);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|i| projected[i as usize] - first);
            draw_front(corners, width, height, &mut self.inverse);
        }
        self.measure_border(camera);
    }

    /// What of a silhouette the mesh leaves uncovered.
    pub(super) fn uncovered(&self, silhouette: &Silhouette) -> Uncovered {
        // A coordinate before the first pixel wraps, so that it is beyond the last one.
        Uncovered::count(silhouette, &|x, y| {
            let (x, y) = (x.wrapping_sub(self.x as usize), y.wrapping_sub(self.y as usize));
            let (width, height) = (self.width as usize, self.height as usize);
            x < width && y < height && self.inverse[y * width + x] > 0.0
        })
    }

    /// If the camera sees the surface at this pixel and depth: the distance in pixels to the nearest depth step.
    ///
    /// `gradient` is the change of the surface's inverse depth per pixel. The surface counts as visible up to
    /// `tolerance` behind the front, in scene units of depth.
    pub(super) fn visible(&self, pixel: Vec3, gradient: Vec2, tolerance: f32) -> Option<f32> {
        let (u, v) = (pixel.x - self.x as f32, pixel.y - self.y as f32);
        // Written so that NaN fails as well.
        if !(pixel.z > 0.0 && u >= 0.0 && v >= 0.0 && u < (self.width - 1) as f32 && v < (self.height - 1) as f32) {
            return None;
        }
        let i = v as usize * self.width as usize + u as usize;
        let corners = [i, i + 1, i + self.width as usize, i + self.width as usize + 1];
        let (fx, fy) = (u - (u as i32) as f32, v - (v as i32) as f32);
        let limit = 1.0 / (pixel.z - tolerance);
        for (k, &corner) in corners.iter().enumerate() {
            let offset = Vec2::new((k % 2) as f32 - fx, (k / 2) as f32 - fy);
            if self.inverse[corner] > limit + gradient.dot(offset) {
                return None;
            }
        }
        // Interpolated bilinearly, so that the weights derived from it are smooth over the surface.
        let [a, b, c, d] = corners.map(|c| f32::from(self.border[c]));
        let (top, bottom) = (a + (b - a) * fx, c + (d - c) * fx);
        // The step lies half a pixel beyond the centre of the last pixel.
        Some(top + (bottom - top) * fy - 0.5)
    }

    /// Sets the covered part: the bounds of the projected vertices, with a margin of background, clipped to the
    /// picture.
    fn frame(&mut self, camera: &Pinhole, projected: &[Vec3]) {
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        for p in projected.iter().filter(|p| p.z > 0.0) {
            low = low.min(p.truncate());
            high = high.max(p.truncate());
        }
        let clamp = |v: f32, n: u32| libm::floorf(v).clamp(0.0, n as f32) as i32;
        (self.x, self.y) = (clamp(low.x - 1.0, camera.width), clamp(low.y - 1.0, camera.height));
        self.width = (clamp(high.x + 3.0, camera.width) - self.x).max(0);
        self.height = (clamp(high.y + 3.0, camera.height) - self.y).max(0);
    }

    /// Computes the chessboard distance of every pixel to the nearest depth step.
    fn measure_border(&mut self, camera: &Pinhole) {
        let (w, h) = (self.width as usize, self.height as usize);
        self.border.clear();
        self.border.resize(w * h, 0);
        let step = |a: f32, b: f32| {
            // |1/a - 1/b| > STEP_FOOTPRINTS · depth / focal, without a division.
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
        chessboard::spread(w, h, &mut self.border);
    }
}
