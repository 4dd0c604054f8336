//! Silhouettes against the picture of the hull that they carve together.

use crate::{
    error::Result,
    executor::Executor,
    math::select,
    point_cloud::Mesh,
    progress::{self, Progress},
    raster::{area, cover},
    silhouette::{Silhouette, stored},
    stage::Stage,
    view::View,
};
use alloc::vec::Vec;
use glam::{Vec2, Vec3};

/// A silhouette against the hull's picture.
#[derive(Debug, Clone, Copy, Default)]
pub struct Comparison {
    /// Intersection over union. `None` without a silhouette, or if both are empty.
    pub overlap: Option<f32>,
    /// The same for the inverted silhouette.
    pub inverted: Option<f32>,
    /// Median distance in pixels of the hull's outline from the contour.
    pub contour: Option<f32>,
    /// Mean distance in pixels between the hull's outline and the contour: the area in which they differ over the length
    /// of the outline. `None` where `overlap` is.
    pub apart: Option<f32>,
    /// Whether any vertex of the hull's mesh lies in the picture.
    pub in_picture: bool,
}

/// Buffers for one comparison after another.
#[derive(Debug, Default)]
struct Scratch {
    projected: Vec<Vec3>,
    covered: Vec<bool>,
    distances: Vec<u32>,
}

/// Compares every view's silhouette with the picture of the hull's mesh. The results are in the order of the views.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub fn compare(
    views: &[View],
    mesh: &Mesh,
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<Comparison>> {
    let compared = executor.map_with(&mut Vec::<Scratch>::new(), views.len(), |scratch, i| {
        progress::step(progress, Stage::Hull, i as u32, views.len() as u32)?;
        Ok(scratch.compare(&views[i], mesh))
    });
    compared.into_iter().collect()
}

impl Scratch {
    fn compare(&mut self, view: &View, mesh: &Mesh) -> Comparison {
        let Self { projected, covered, distances } = self;
        projected.clear();
        projected.extend(mesh.positions.iter().map(|&p| view.camera.project(p)));
        let size = [view.camera.width as i32, view.camera.height as i32];
        // The part of the picture that the mesh may cover, with a margin of one pixel.
        let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let mut in_picture = false;
        for p in projected.iter().filter(|p| p.z > 0.0) {
            (low, high) = (low.min(p.truncate()), high.max(p.truncate()));
            in_picture |= p.x >= -0.5 && p.y >= -0.5 && p.x < size[0] as f32 - 0.5 && p.y < size[1] as f32 - 0.5;
        }
        let Some(silhouette) = view.silhouette_as_given() else {
            return Comparison { in_picture, ..Comparison::default() };
        };
        let clamp = |v: f32, n: i32| libm::floorf(v).clamp(0.0, n as f32) as usize;
        let first = [clamp(low.x - 1.0, size[0]), clamp(low.y - 1.0, size[1])];
        let end = [clamp(high.x + 3.0, size[0]), clamp(high.y + 3.0, size[1])];
        let [w, h] = [0, 1].map(|axis| end[axis].saturating_sub(first[axis]));
        covered.clear();
        covered.resize(w * h, false);
        let corner = Vec3::new(first[0] as f32, first[1] as f32, 0.0);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|i| projected[i as usize] - corner);
            // The front faces of a closed mesh cover what all of them cover.
            if area(corners) < 0.0 {
                cover(corners, w, h, |x, y, _, _| covered[y * w + x] = true);
            }
        }
        let part = Part { covered, first, size: [w, h], silhouette };
        let ([overlap, inverted], differing) = part.overlaps();
        let contour = part.contour(distances);
        let apart = overlap.filter(|_| !distances.is_empty()).map(|_| differing as f32 / distances.len() as f32);
        Comparison { overlap, inverted, contour, apart, in_picture }
    }
}

/// The part of a picture that the mesh covers, and the silhouette.
struct Part<'a> {
    covered: &'a [bool],
    /// First column and row, width and height in pixels.
    first: [usize; 2],
    size: [usize; 2],
    silhouette: &'a Silhouette,
}

impl Part<'_> {
    /// A row of the part: what is covered, and the silhouette's distances.
    fn row(&self, y: usize) -> (&[bool], &[i16]) {
        let [w, _] = self.size;
        let start = (self.first[1] + y) * self.silhouette.width as usize + self.first[0];
        (&self.covered[y * w..][..w], &self.silhouette.distances()[start..][..w])
    }

    /// Intersection over union with the silhouette and with its inverse, over the pixels that have a source, and the number
    /// of pixels in which the silhouette differs.
    fn overlaps(&self) -> ([Option<f32>; 2], u32) {
        let (mut inside, mut outside) = (0u32, 0u32);
        for &d in self.silhouette.distances() {
            inside += u32::from(d > 0 && d != Silhouette::UNKNOWN);
            outside += u32::from(d <= 0);
        }
        let (mut both, mut only_mesh) = (0u32, 0u32);
        for y in 0..self.size[1] {
            let (covered, distances) = self.row(y);
            for (&covered, &d) in covered.iter().zip(distances) {
                both += u32::from(covered && d > 0 && d != Silhouette::UNKNOWN);
                only_mesh += u32::from(covered && d <= 0);
            }
        }
        if self.silhouette.is_full() {
            return ([None; 2], 0);
        }
        let share = |common: u32, all: u32| (all > 0).then(|| common as f32 / all as f32);
        let all = inside + only_mesh;
        ([share(both, all), share(only_mesh, outside + both)], all - both)
    }

    /// Median distance of the covered part's outline from the contour, in pixels. The outline passes between pairs of
    /// neighbouring pixels of which one is covered. The picture's edge is none.
    fn contour(&self, distances: &mut Vec<u32>) -> Option<f32> {
        distances.clear();
        if self.silhouette.is_full() {
            return None;
        }
        let mut between = |a: i16, b: i16| {
            if a != Silhouette::UNKNOWN && b != Silhouette::UNKNOWN {
                // The sum of two distances is twice the one in the middle.
                distances.push((i32::from(a) + i32::from(b)).unsigned_abs());
            }
        };
        for y in 0..self.size[1] {
            let (covered, d) = self.row(y);
            let (left, right) = (&covered[..covered.len().saturating_sub(1)], covered.get(1..).unwrap_or_default());
            for_differing(left, right, |x| between(d[x + 1], d[x]));
            if y > 0 {
                let (above, e) = self.row(y - 1);
                for_differing(covered, above, |x| between(d[x], e[x]));
            }
        }
        let middle = distances.len() / 2;
        (!distances.is_empty()).then(|| stored::pixels(select(distances, middle) as f32 * 0.5))
    }
}

/// Calls `f` with the places at which two rows differ. They do so at few places only, so that many are compared together.
fn for_differing(a: &[bool], b: &[bool], mut f: impl FnMut(usize)) {
    const TOGETHER: usize = 64;
    for (part, (a, b)) in a.chunks(TOGETHER).zip(b.chunks(TOGETHER)).enumerate() {
        if a != b {
            (0..a.len()).filter(|&i| a[i] != b[i]).for_each(|i| f(part * TOGETHER + i));
        }
    }
}
