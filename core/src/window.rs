//! The part of a picture that the stages after the hull read.

use crate::{camera::Pinhole, math::floor, point_cloud::Mesh};
use alloc::vec::Vec;

/// Distance in pixels from the picture of the hull to the edge of its window. Windows of stereo at a few octaves, the
/// kernels of colours and evaluations around the hull's surface reach so far.
const MARGIN: i32 = 32;
/// The edges of a window are multiples of this many pixels, so that its first octaves are those of the whole picture.
const STEP: u32 = 16;

/// A rectangle of pixels of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Window {
    /// Column and row of the first pixel.
    pub x: u32,
    pub y: u32,
    /// Size in pixels, at least 2 x 2 in a picture of that size.
    pub width: u32,
    pub height: u32,
}

impl Window {
    /// The window in which a camera's picture shows a mesh.
    pub fn around(mesh: &Mesh, camera: &Pinhole) -> Self {
        let (mut low, mut high) = ([i32::MAX; 2], [i32::MIN; 2]);
        for &p in &mesh.positions {
            let q = camera.project(p);
            if q.z <= 0.0 {
                // The object reaches behind the camera, so that it may be anywhere in the picture.
                (low, high) = ([i32::MIN; 2], [i32::MAX; 2]);
                break;
            }
            for (axis, v) in [floor(q.x), floor(q.y)].into_iter().enumerate() {
                (low[axis], high[axis]) = (low[axis].min(v), high[axis].max(v));
            }
        }
        let [(x, width), (y, height)] =
            [(0, camera.width), (1, camera.height)].map(|(axis, size)| part(low[axis], high[axis], size));
        Self { x, y, width, height }
    }

    /// The camera of the window, from that of the whole picture.
    pub fn camera(&self, whole: &Pinhole) -> Pinhole {
        whole.part([self.x, self.y], [self.width, self.height])
    }

    /// Number of pixels.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Its pixels of a picture with `width` columns, whose pixels have `channels` values, row after row.
    pub fn of<T: Copy>(&self, picture: &[T], width: u32, channels: usize) -> Vec<T> {
        let mut part = Vec::with_capacity(self.pixels() * channels);
        let rows = picture.chunks_exact(width as usize * channels).skip(self.y as usize).take(self.height as usize);
        rows.for_each(|row| {
            part.extend_from_slice(&row[self.x as usize * channels..][..self.width as usize * channels])
        });
        part
    }
}

/// First pixel and size of a window along one axis of a picture with `size` pixels, around the pixels from `low` to `high`.
fn part(low: i32, high: i32, size: u32) -> (u32, u32) {
    let last = size as i32 - 1;
    let first = low.saturating_sub(MARGIN).clamp(0, last) as u32 / STEP * STEP;
    let end = (high.saturating_add(MARGIN).clamp(0, last) as u32 + 1).next_multiple_of(STEP).min(size).max(first + 1);
    // Silhouettes have at least two pixels along each axis.
    let first = if end - first < 2 { first.saturating_sub(STEP) } else { first };
    (first, end - first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{pinhole, sphere};
    use glam::Vec3;

    #[test]
    fn a_window_contains_the_mesh_and_its_margin() {
        let mesh = sphere(Vec3::ZERO, 0.5);
        let camera = pinhole(Vec3::new(5.0, 0.3, 0.2), Vec3::new(0.0, 0.0, 0.4), 400, 500.0);
        let window = Window::around(&mesh, &camera);
        assert!(
            window.x.is_multiple_of(STEP) && window.y.is_multiple_of(STEP) && window.pixels() < 400 * 400 / 2,
            "{window:?}"
        );
        let seen = window.camera(&camera);
        for &p in &mesh.positions {
            let (whole, part) = (camera.project(p), seen.project(p));
            assert!((whole - part - Vec3::new(window.x as f32, window.y as f32, 0.0)).abs().max_element() < 1e-3);
            let margin = MARGIN as f32;
            let (w, h) = (window.width as f32 - margin, window.height as f32 - margin);
            assert!(part.x >= margin && part.y >= margin && part.x < w && part.y < h, "{part} in {window:?}");
            let back = seen.unproject(part.x, part.y, part.z);
            assert!(back.distance(p) < 1e-5, "{back} for {p}");
        }
    }

    #[test]
    fn windows_stay_within_the_picture() {
        assert_eq!(part(-1000, -900, 401), (0, 16), "beside the first pixel");
        assert_eq!(part(1000, 1100, 401), (384, 17), "beside the last pixel");
        assert_eq!(part(1000, 1100, 385), (368, 17));
        assert_eq!(part(i32::MIN, i32::MAX, 401), (0, 401));
        assert_eq!(part(i32::MAX, i32::MIN, 401), (384, 17), "nothing");
        assert_eq!(part(100, 200, 401), (64, 176));
        assert_eq!(part(0, 1, 2), (0, 2));
    }

    #[test]
    fn an_object_around_the_camera_takes_the_whole_picture() {
        let camera = pinhole(Vec3::new(0.2, 0.0, 0.0), Vec3::ZERO, 90, 50.0);
        let window = Window::around(&sphere(Vec3::ZERO, 0.5), &camera);
        assert_eq!(window, Window { x: 0, y: 0, width: 90, height: 90 });
    }

    #[test]
    fn its_pixels_are_those_of_the_picture() {
        let picture: Vec<u32> = (0..5 * 4 * 3).collect();
        let window = Window { x: 2, y: 1, width: 2, height: 2 };
        assert_eq!(window.of(&picture, 5, 3), [21, 22, 23, 24, 25, 26, 36, 37, 38, 39, 40, 41]);
    }
}
