//! What every mesh is.

use pcmvs_core::Mesh;
use std::collections::BTreeSet;

/// Fails unless a mesh is finite and closed: every directed edge occurs once, and so does its opposite.
pub fn assert_closed(mesh: &Mesh) {
    assert!(!mesh.triangles.is_empty(), "there is no mesh");
    assert!(mesh.positions.iter().chain(&mesh.normals).all(|v| v.is_finite()), "a number is none");
    let mut edges = BTreeSet::new();
    for triangle in &mesh.triangles {
        for k in 0..3 {
            assert!(edges.insert((triangle[k], triangle[(k + 1) % 3])), "an edge occurs twice");
        }
    }
    assert!(edges.iter().all(|&(from, to)| edges.contains(&(to, from))), "the mesh is open");
}
