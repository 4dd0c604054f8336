//! A mesh prepared for being laid onto another: in pixels of footprint, with colours smoothed to several degrees.

use crate::{executor::Executor, neighbour_grid::NeighbourGrid, point_cloud::Mesh, surface::VertexNeighbours};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Vertices that one job of an executor works on.
pub(super) const VERTICES_PER_JOB: usize = 4096;

/// How often colours are averaged with their neighbours, from the finest to the coarsest degree.
const ROUNDS: [u32; DEGREES] = [1, 4, 16];
/// Number of degrees to which colours are smoothed.
pub(super) const DEGREES: usize = 3;

pub(super) struct Target<'a> {
    pub mesh: &'a Mesh,
    /// Positions in pixels of footprint.
    pub positions: Vec<Vec3>,
    pub neighbours: VertexNeighbours,
    /// sRGB colours, smoothed to each degree.
    pub colours: [Vec<Vec3>; DEGREES],
}

/// The nearest place on a mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub position: Vec3,
    pub normal: Vec3,
    pub colour: Vec3,
}

impl<'a> Target<'a> {
    pub fn new(mesh: &'a Mesh, per_unit: f32, executor: &dyn Executor) -> Self {
        let neighbours = VertexNeighbours::new(mesh);
        let mut colours: [Vec<Vec3>; DEGREES] = Default::default();
        let mut smooth: Vec<Vec3> = mesh.colours.iter().map(|&rgb| Vec3::from_array(rgb.map(f32::from))).collect();
        let mut done = 0;
        for (degree, rounds) in ROUNDS.into_iter().enumerate() {
            while done < rounds {
                smooth = smoothed(&smooth, &neighbours, executor);
                done += 1;
            }
            colours[degree].clone_from(&smooth);
        }
        let positions = mesh.positions.iter().map(|&p| p * per_unit).collect();
        Self { mesh, positions, neighbours, colours }
    }

    /// Gradient along the surface of the luma of a degree, in grey levels per pixel, for every vertex.
    pub fn gradients(&self, degree: usize, executor: &dyn Executor) -> Vec<Vec3> {
        let colours = &self.colours[degree];
        let mut gradients = vec![Vec3::ZERO; self.positions.len()];
        executor.map_parts(gradients.chunks_mut(VERTICES_PER_JOB), |part, gradients| {
            for (v, gradient) in (part * VERTICES_PER_JOB..).zip(gradients) {
                let (p, n, l) = (self.positions[v], self.mesh.normals[v], luma(colours[v]));
                let (s, t) = n.any_orthonormal_pair();
                // Least squares in the tangent plane.
                let (mut aa, mut ab, mut bb, mut a, mut b) = (0.0, 0.0, 0.0, 0.0, 0.0);
                for &other in self.neighbours.of(v as u32) {
                    let (d, rise) = (self.positions[other as usize] - p, luma(colours[other as usize]) - l);
                    let (x, y) = (d.dot(s), d.dot(t));
                    (aa, ab, bb) = (aa + x * x, ab + x * y, bb + y * y);
                    (a, b) = (a + x * rise, b + y * rise);
                }
                let determinant = aa * bb - ab * ab;
                if determinant > 1e-3 * (aa + bb) * (aa + bb) {
                    *gradient = (s * (a * bb - b * ab) + t * (b * aa - a * ab)) / determinant;
                }
            }
        });
        gradients
    }

    /// Every `stride`th vertex, sorted for queries within `radius` pixels.
    pub fn grid(&self, stride: usize, radius: f32) -> NeighbourGrid {
        let count = self.positions.len().div_ceil(stride);
        NeighbourGrid::new((0..count).map(|i| self.positions[i * stride]), radius)
    }

    /// The place nearest to `p` on the triangles around a vertex.
    pub fn nearest_around(&self, v: u32, p: Vec3) -> Place {
        let mut best = Place {
            position: self.positions[v as usize],
            normal: self.mesh.normals[v as usize],
            colour: Vec3::from_array(self.mesh.colours[v as usize].map(f32::from)),
        };
        let mut least = best.position.distance_squared(p);
        for pair in self.neighbours.of(v).chunks_exact(2) {
            let corners = [v, pair[0], pair[1]].map(|v| v as usize);
            let weights = barycentric(corners.map(|v| self.positions[v]), p);
            let mix = |of: &dyn Fn(usize) -> Vec3| {
                of(corners[0]) * weights[0] + of(corners[1]) * weights[1] + of(corners[2]) * weights[2]
            };
            let position = mix(&|v| self.positions[v]);
            let distance = position.distance_squared(p);
            if distance < least {
                least = distance;
                let normal = mix(&|v| self.mesh.normals[v]);
                let colour = mix(&|v| Vec3::from_array(self.mesh.colours[v].map(f32::from)));
                best = Place { position, normal: normal.normalize_or(best.normal), colour };
            }
        }
        best
    }
}

/// Luma of BT.601.
pub(super) fn luma(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.299, 0.587, 0.114))
}

/// Each colour averaged with the mean of its neighbours.
fn smoothed(colours: &[Vec3], neighbours: &VertexNeighbours, executor: &dyn Executor) -> Vec<Vec3> {
    let mut out = vec![Vec3::ZERO; colours.len()];
    executor.map_parts(out.chunks_mut(VERTICES_PER_JOB), |part, out| {
        for (v, out) in (part * VERTICES_PER_JOB..).zip(out) {
            let around = neighbours.of(v as u32);
            let sum: Vec3 = around.iter().map(|&n| colours[n as usize]).sum();
            *out = if around.is_empty() { colours[v] } else { 0.5 * (colours[v] + sum / around.len() as f32) };
        }
    });
    out
}

/// Barycentric coordinates of the place of a triangle that is nearest to `p` (Ericson, Real-Time Collision Detection, 2005,
/// §5.1.5).
fn barycentric([a, b, c]: [Vec3; 3], p: Vec3) -> [f32; 3] {
    let (ab, ac) = (b - a, c - a);
    let from = |corner: Vec3| (ab.dot(p - corner), ac.dot(p - corner));
    let ((d1, d2), (d3, d4), (d5, d6)) = (from(a), from(b), from(c));
    let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
    if d1 <= 0.0 && d2 <= 0.0 {
        [1.0, 0.0, 0.0]
    } else if d3 >= 0.0 && d4 <= d3 {
        [0.0, 1.0, 0.0]
    } else if d6 >= 0.0 && d5 <= d6 {
        [0.0, 0.0, 1.0]
    } else if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / (d1 - d3);
        [1.0 - t, t, 0.0]
    } else if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / (d2 - d6);
        [1.0 - t, 0.0, t]
    } else if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        [0.0, 1.0 - t, t]
    } else {
        let sum = va + vb + vc;
        [va / sum, vb / sum, vc / sum]
    }
}
