//! Checks that a mesh is a closed, oriented manifold.

use pcmvs_core::Mesh;
use std::collections::{BTreeMap, BTreeSet};

/// Fails unless a mesh is there, a closed manifold, and oriented outward; `what` names it in the message.
#[track_caller]
pub fn assert_sound(mesh: &Mesh, what: &str) {
    assert!(!mesh.triangles.is_empty(), "{what}: there is no mesh");
    assert_manifold(mesh, what);
    let inverted = components(mesh).iter().filter(|c| c.volume <= 0.0).count();
    assert_eq!(inverted, 0, "{what}: components are inside out");
}

/// Fails unless a mesh is finite, closed, consistently oriented and manifold, with unit normals and without triangles
/// that are given twice or have no area.
#[track_caller]
pub fn assert_manifold(mesh: &Mesh, what: &str) {
    assert_eq!(mesh.positions.len(), mesh.normals.len(), "{what}");
    assert!(mesh.positions.iter().all(|p| p.is_finite()), "{what}: a position is not finite");
    let unit = mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4);
    assert!(unit, "{what}: a normal is not a unit vector");

    // The third corner of the triangle of each directed edge.
    let mut edges: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let mut triangles = BTreeSet::new();
    for &t in &mesh.triangles {
        let mut sorted = t;
        sorted.sort_unstable();
        assert!(triangles.insert(sorted), "{what}: triangle {t:?} occurs twice");
        let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
        assert!((b - a).cross(c - a).length() > 0.0, "{what}: triangle {t:?} has no area");
        for k in 0..3 {
            let (from, to) = (t[k], t[(k + 1) % 3]);
            let before = edges.insert((from, to), t[(k + 2) % 3]);
            assert!(before.is_none(), "{what}: edge {from} {to} has two triangles on one side");
        }
    }
    let mut around = vec![(0u32, 0u32); mesh.positions.len()];
    for &(from, to) in edges.keys() {
        assert!(edges.contains_key(&(to, from)), "{what}: edge {from} {to} is open");
        around[from as usize] = (around[from as usize].0 + 1, to);
    }
    for (vertex, &(count, first)) in around.iter().enumerate() {
        assert!(count > 0, "{what}: no triangle uses vertex {vertex}");
        let (mut at, mut turned) = (first, 0);
        loop {
            at = edges[&(vertex as u32, at)];
            turned += 1;
            if at == first {
                break;
            }
        }
        assert_eq!(turned, count, "{what}: vertex {vertex} joins two fans of triangles");
    }
}

/// A connected component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Component {
    /// Number of vertices.
    pub vertices: u32,
    /// Enclosed volume, negative if the triangles face inward.
    pub volume: f64,
}

/// The connected components of a mesh, in the order of their first vertices.
pub fn components(mesh: &Mesh) -> Vec<Component> {
    let mut root: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for t in &mesh.triangles {
        for v in &t[1..] {
            let (a, b) = (find(&mut root, t[0]), find(&mut root, *v));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    let mut found: Vec<Component> = Vec::new();
    let mut index = vec![0; root.len()];
    for v in 0..root.len() as u32 {
        let first = find(&mut root, v);
        if first == v {
            index[v as usize] = found.len();
            found.push(Component { vertices: 0, volume: 0.0 });
        }
        found[index[first as usize]].vertices += 1;
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
        found[index[find(&mut root, t[0]) as usize]].volume += a.dot(b.cross(c)) / 6.0;
    }
    found
}

/// The first vertex of a vertex's component. Compresses the path to it.
fn find(root: &mut [u32], mut v: u32) -> u32 {
    while root[v as usize] != v {
        let next = root[root[v as usize] as usize];
        root[v as usize] = next;
        v = next;
    }
    v
}
