//! The neighbours of the vertices of a mesh.

use crate::point_cloud::Mesh;
use alloc::{vec, vec::Vec};

/// The other corners of the triangles around each vertex, in pairs: a triangle (v, a, b) gives its corner v the pair a, b.
/// The other end of an edge is therefore listed once per triangle at the edge.
pub(crate) struct VertexNeighbours {
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl VertexNeighbours {
    pub fn new(mesh: &Mesh) -> Self {
        Self::of_some(mesh, |_| true)
    }

    /// The lists of the vertices that are `wanted`. Those of all others are empty.
    pub fn of_some(mesh: &Mesh, wanted: impl Fn(u32) -> bool) -> Self {
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        let corners =
            || mesh.triangles.iter().flat_map(|t| (0..3).map(move |k| (t[k], [t[(k + 1) % 3], t[(k + 2) % 3]])));
        for (v, _) in corners().filter(|&(v, _)| wanted(v)) {
            starts[v as usize + 1] += 2;
        }
        for v in 0..mesh.positions.len() {
            starts[v + 1] += starts[v];
        }
        let mut list = vec![0u32; starts[mesh.positions.len()] as usize];
        let mut next = starts.clone();
        for (v, others) in corners().filter(|&(v, _)| wanted(v)) {
            let at = &mut next[v as usize];
            list[*at as usize..][..2].copy_from_slice(&others);
            *at += 2;
        }
        Self { starts, list }
    }

    pub fn of(&self, v: u32) -> &[u32] {
        &self.list[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }
}
