//! Errors of a reconstruction against the solid. Lengths are in metres.

use crate::{mesh::TriangleMesh, solid::Solid};
use glam::DVec3;
use pcmvs_core::Camera;

/// Signed distances (negative inside the solid) of points spread evenly over a mesh, in ascending order of magnitude.
pub fn errors(solid: &Solid, mesh: &TriangleMesh, samples: usize) -> Vec<f64> {
    let mut errors: Vec<f64> = mesh.surface_points(samples, 0).into_iter().map(|p| solid.distance(p)).collect();
    errors.sort_by(|a, b| libm::fabs(*a).total_cmp(&libm::fabs(*b)));
    errors
}

/// The distance from the solid within which a share of a mesh's surface lies. 0.9 gives Middlebury's accuracy.
pub fn accuracy(solid: &Solid, mesh: &TriangleMesh, share: f64, samples: usize) -> f64 {
    let errors = errors(solid, mesh, samples);
    let rank = libm::ceil(share * errors.len() as f64) as usize;
    libm::fabs(errors[rank.clamp(1, errors.len()) - 1])
}

/// Share (0..=1) of the given points whose distance from a mesh is at most `within`.
pub fn completeness(points: &[(DVec3, DVec3)], mesh: &TriangleMesh, within: f64) -> f64 {
    let grid = TriangleGrid::new(mesh, within);
    points.iter().filter(|(p, _)| grid.distance(*p).is_some()).count() as f64 / points.len() as f64
}

/// Whether a camera sees a surface point with a normal: it is in the picture, faces the camera and is not occluded.
pub fn sees(solid: &Solid, camera: &Camera, point: DVec3, normal: DVec3) -> bool {
    let Some((pixel, _)) = camera.project(point) else {
        return false;
    };
    let (right, bottom) = (f64::from(camera.width) - 1.0, f64::from(camera.height) - 1.0);
    if pixel.x < 0.0 || pixel.y < 0.0 || pixel.x > right || pixel.y > bottom {
        return false;
    }
    let to = point - camera.centre();
    let distance = to.length();
    let direction = to / distance;
    let parts = solid.near(camera.centre(), direction, 0.0, 0.0);
    // Stops a millimetre before the point.
    normal.dot(direction) < -0.05 && solid.trace(camera.centre(), direction, 0.0, distance - 1e-3, parts).is_none()
}

/// Points (with normals) of the solid's surface that at least `least` cameras see.
pub fn seen(solid: &Solid, cameras: &[Camera], least: usize, samples: usize) -> Vec<(DVec3, DVec3)> {
    let mut points = solid.surface_points(samples, 0);
    points.retain(|(p, n)| cameras.iter().filter(|c| sees(solid, c, *p, *n)).take(least).count() >= least);
    points
}

/// Triangles in cubic cells, for searches of the nearest one within the side of a cell.
pub struct TriangleGrid<'a> {
    mesh: &'a TriangleMesh,
    reach: f64,
    /// Cells and triangles, sorted.
    entries: Vec<([i32; 3], u32)>,
}

impl<'a> TriangleGrid<'a> {
    /// A grid that finds triangles within `reach`.
    pub fn new(mesh: &'a TriangleMesh, reach: f64) -> Self {
        let mut grid = Self { mesh, reach, entries: Vec::new() };
        for face in 0..mesh.faces.len() {
            let [a, b, c] = mesh.corners(face);
            let (low, high) = (grid.cell(a.min(b).min(c)), grid.cell(a.max(b).max(c)));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    grid.entries.extend((low[2]..=high[2]).map(|z| ([x, y, z], face as u32)));
                }
            }
        }
        grid.entries.sort_unstable();
        grid
    }

    fn cell(&self, p: DVec3) -> [i32; 3] {
        (p / self.reach).to_array().map(|v| libm::floor(v) as i32)
    }

    /// Distance of the nearest triangle, if one is within reach.
    pub fn distance(&self, p: DVec3) -> Option<f64> {
        let mut least = f64::MAX;
        self.near(p, |face| least = least.min(to_triangle(p, self.mesh.corners(face))));
        (least <= self.reach).then_some(least)
    }

    /// How far the mesh is from `p` along a unit vector, negative against it, and in which of its triangles: the nearest of
    /// all places within reach.
    pub fn along(&self, p: DVec3, direction: DVec3) -> Option<(f64, usize)> {
        let mut nearest: Option<(f64, usize)> = None;
        self.near(p, |face| {
            let Some(s) = crossing(p, direction, self.mesh.corners(face)) else { return };
            if libm::fabs(s) <= self.reach && nearest.is_none_or(|(other, _)| libm::fabs(s) < libm::fabs(other)) {
                nearest = Some((s, face));
            }
        });
        nearest
    }

    /// Calls `f` with all triangles that may be within reach.
    fn near(&self, p: DVec3, mut f: impl FnMut(usize)) {
        let [x, y, z] = self.cell(p);
        for i in x - 1..=x + 1 {
            for j in y - 1..=y + 1 {
                // Cells that are consecutive in z are consecutive in the list.
                let from = self.entries.partition_point(|(cell, _)| *cell < [i, j, z - 1]);
                for (cell, face) in &self.entries[from..] {
                    if *cell > [i, j, z + 1] {
                        break;
                    }
                    f(*face as usize);
                }
            }
        }
    }
}

/// Where a line crosses a triangle, as a multiple of its direction.
fn crossing(p: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let normal = (b - a).cross(c - a);
    let slope = normal.dot(direction);
    if slope == 0.0 {
        return None;
    }
    let s = normal.dot(a - p) / slope;
    let q = p + direction * s;
    [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| normal.cross(to - from).dot(q - from) >= 0.0).then_some(s)
}

/// Distance of a point from a triangle.
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let edges = [(a, b), (b, c), (c, a)];
    let above = edges.iter().all(|&(from, to)| normal.cross(to - from).dot(p - from) >= 0.0);
    if above && normal.length_squared() > 0.0 {
        return libm::fabs(normal.dot(p - a)) / normal.length();
    }
    edges.into_iter().map(|(from, to)| to_segment(p, from, to)).fold(f64::MAX, f64::min)
}

fn to_segment(p: DVec3, from: DVec3, to: DVec3) -> f64 {
    let along = to - from;
    let t = (p - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
    (p - from - along * t.clamp(0.0, 1.0)).length()
}
