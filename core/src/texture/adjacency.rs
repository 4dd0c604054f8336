//! Which triangles of a mesh share an edge.

use crate::point_cloud::Mesh;
use alloc::{vec, vec::Vec};

/// Stands for the missing neighbour at the border of an open mesh.
pub(super) const NONE: u32 = u32::MAX;

/// For each triangle, the triangle across the edge from corner k to corner k + 1. Where more than two triangles share
/// an edge, they are paired in the order of their indices.
pub(super) fn adjacency(mesh: &Mesh) -> Vec<[u32; 3]> {
    let mut edges: Vec<(u64, u32)> = Vec::with_capacity(mesh.triangles.len() * 3);
    for (t, corners) in mesh.triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            edges.push((u64::from(a.min(b)) << 32 | u64::from(a.max(b)), (t * 3 + k) as u32));
        }
    }
    edges.sort_unstable();
    let mut neighbours = vec![[NONE; 3]; mesh.triangles.len()];
    let mut i = 0;
    while i + 1 < edges.len() {
        let ((edge, a), (other, b)) = (edges[i], edges[i + 1]);
        if edge != other {
            i += 1;
            continue;
        }
        neighbours[a as usize / 3][a as usize % 3] = b / 3;
        neighbours[b as usize / 3][b as usize % 3] = a / 3;
        i += 2;
    }
    neighbours
}
