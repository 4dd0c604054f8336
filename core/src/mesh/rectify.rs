//! The space constraint as in the paper (§6.2): vertices outside the hull are rectified, and the solver runs again.

use alloc::vec::Vec;
use glam::Vec3;

use crate::point_cloud::{Mesh, Point, Rank};
use crate::surface::Envelope;

/// Number of bisections of one voxel.
const BISECTIONS: u32 = 8;
/// Largest distance that a vertex may move, in voxels.
const FARTHEST: u32 = 64;

/// The vertices of the mesh, as points for the second reconstruction. Vertices outside the envelope move along their
/// inverse normal onto the envelope, and take its normal there. Vertices whose inverse normal misses the envelope are
/// omitted.
pub(super) fn rectified(mesh: &Mesh, envelope: &dyn Envelope, voxel: f32) -> Vec<Point> {
    let mut points = Vec::with_capacity(mesh.positions.len());
    for (&vertex, &outward) in mesh.positions.iter().zip(&mesh.normals) {
        let mut point = Point {
            position: vertex,
            normal: outward,
            fidelity: 0.0,
            sigma: 0.0,
            weight: 1.0,
            view: Point::NO_VIEW,
            rank: Rank::Detected,
        };
        if envelope.signed_distance(vertex) < 0.0 {
            let Some(position) = follow(vertex, -outward, envelope, voxel) else { continue };
            let normal = -gradient(envelope, position, 0.5 * voxel);
            let length = normal.length();
            if length > 0.0 {
                point = Point { position, normal: normal / length, ..point };
            }
        }
        points.push(point);
    }
    points
}

/// The point where a ray from outside enters the envelope.
fn follow(from: Vec3, direction: Vec3, envelope: &dyn Envelope, voxel: f32) -> Option<Vec3> {
    let inside = |t: f32| envelope.signed_distance(from + direction * t) >= 0.0;
    let reached = (1..=FARTHEST).map(|i| i as f32 * voxel).find(|&t| inside(t))?;
    let (mut low, mut high) = (reached - voxel, reached);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if inside(middle) { high = middle } else { low = middle }
    }
    Some(from + direction * high)
}

/// Gradient of the signed distance by central differences.
fn gradient(envelope: &dyn Envelope, p: Vec3, step: f32) -> Vec3 {
    let along = |axis: Vec3| envelope.signed_distance(p + axis * step) - envelope.signed_distance(p - axis * step);
    Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)) / (2.0 * step)
}
