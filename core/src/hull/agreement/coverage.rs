//! The pixels of a silhouette that the hull does not cover.

use crate::{camera::Pinhole, point_cloud::Mesh, silhouette::Silhouette};
use alloc::vec::Vec;

/// Smallest distance of a pixel from the contour, in pixels. Contours are not more accurate.
const DEEP: f32 = 1.5;
/// Depth of the rim, in pixels.
const RIM: f32 = 3.0;
/// Every second pixel is looked at, as on the white squares of a chessboard.
pub(super) const PIXELS_PER_SAMPLE: f32 = 2.0;

/// Which pixels a mesh covers. The vertices of the hull's mesh are closer together than the pixels that one of them
/// covers, 3 x 3, so that drawing them is sufficient and fast.
#[derive(Debug, Default)]
pub(super) struct Coverage {
    width: usize,
    height: usize,
    drawn: Vec<bool>,
}

impl Coverage {
    /// Draws a mesh as seen from a camera.
    pub(super) fn draw(&mut self, mesh: &Mesh, camera: &Pinhole) {
        (self.width, self.height) = (camera.width as usize, camera.height as usize);
        self.drawn.clear();
        self.drawn.resize(self.width * self.height, false);
        for &p in &mesh.positions {
            let q = camera.project(p);
            let (x, y) = (q.x + 0.5, q.y + 0.5);
            if q.z > 0.0 && x >= 0.0 && y >= 0.0 && x < self.width as f32 && y < self.height as f32 {
                self.drawn[y as usize * self.width + x as usize] = true;
            }
        }
    }

    /// Pixels well inside a silhouette that the mesh does not cover. Contours may lie `off` by so many pixels more than usual.
    pub(super) fn uncovered(&self, silhouette: &Silhouette, off: f32) -> Vec<[u16; 2]> {
        let deep = ((DEEP + off) * Silhouette::UNITS) as i16;
        let w = self.width;
        let mut found = Vec::new();
        for y in 1..self.height.saturating_sub(1) {
            for x in (1 + (y & 1)..w.saturating_sub(1)).step_by(2) {
                let i = y * w + x;
                let d = silhouette.distances()[i];
                let is_deep = d >= deep && d != Silhouette::UNKNOWN;
                if is_deep && !(y - 1..=y + 1).any(|y| self.drawn[y * w + x - 1..=y * w + x + 1].contains(&true)) {
                    found.push([x as u16, y as u16]);
                }
            }
        }
        found
    }

    /// Share of a silhouette's rim, the pixels up to [`RIM`] inside the contour, that the mesh does not cover.
    pub(super) fn uncovered_rim(&self, silhouette: &Silhouette) -> f32 {
        let rim = (RIM * Silhouette::UNITS) as i16;
        let d = |x: usize, y: usize| silhouette.distances()[y * self.width + x];
        let all = silhouette.distances().iter().filter(|&&d| d >= (DEEP * Silhouette::UNITS) as i16 && d < rim).count();
        let uncovered = self.uncovered(silhouette, 0.0);
        let open = uncovered.iter().filter(|&&[x, y]| d(usize::from(x), usize::from(y)) < rim).count();
        open as f32 * PIXELS_PER_SAMPLE / all.max(1) as f32
    }
}

/// Length of a silhouette's contour in pixels: the number of pixels on the object whose distance to it is below 1.
pub(super) fn contour_length(silhouette: &Silhouette) -> u32 {
    silhouette.distances().iter().filter(|&&d| d > 0 && d <= Silhouette::UNITS as i16).count() as u32
}

/// Number of a silhouette's pixels.
pub(super) fn area(silhouette: &Silhouette) -> u32 {
    silhouette.distances().iter().filter(|&&d| d > 0 && d != Silhouette::UNKNOWN).count() as u32
}
