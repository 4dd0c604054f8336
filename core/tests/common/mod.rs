//! What the tests of meshes share.
#![allow(dead_code, reason = "each test file is a crate of its own and uses a part")]

use std::collections::{HashMap, HashSet};

use glam::DVec3;
use pcmvs_core::Mesh;

/// A generator of pseudo-random numbers (xorshift64*).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1 << 24) as f32
    }

    /// Uniform below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() as usize) % n
    }

    /// Normally distributed, variance 1.
    pub fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.unit()).sum::<f32>() - 6.0
    }
}

/// Closed, oriented, two triangles an edge, one fan a vertex, no triangle twice or without area, all finite, unit normals.
pub fn assert_manifold(mesh: &Mesh) {
    assert_eq!(mesh.positions.len(), mesh.normals.len());
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));

    let mut edges = HashSet::new();
    let mut triangles = HashSet::new();
    let mut fans: Vec<HashMap<u32, u32>> = vec![HashMap::new(); mesh.positions.len()];
    for &t in &mesh.triangles {
        let mut sorted = t;
        sorted.sort();
        assert!(triangles.insert(sorted), "triangle {t:?} twice");
        let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
        assert!((b - a).cross(c - a).length() > 0.0, "triangle {t:?} has no area");
        for k in 0..3 {
            let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            assert!(edges.insert((a, b)), "edge {a} {b} twice in one direction");
            fans[a as usize].insert(b, c);
        }
    }
    for &(a, b) in &edges {
        assert!(edges.contains(&(b, a)), "edge {a} {b} is open");
    }
    for (vertex, fan) in fans.iter().enumerate() {
        let Some(&first) = fan.keys().next() else { panic!("vertex {vertex} has no triangle") };
        let (mut at, mut seen) = (fan[&first], 1);
        while at != first {
            at = fan[&at];
            seen += 1;
        }
        assert_eq!(seen, fan.len(), "vertex {vertex} has more than one fan");
    }
}

/// Volume that the mesh encloses.
pub fn volume(mesh: &Mesh) -> f64 {
    let corner = |v: u32| -> DVec3 { mesh.positions[v as usize].as_dvec3() };
    mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum()
}
