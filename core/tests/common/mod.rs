//! What the tests of meshes share.
#![allow(dead_code, reason = "each test file is a crate of its own and uses a part")]

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

/// The mesh is a closed manifold.
#[track_caller]
pub fn assert_manifold(mesh: &Mesh) {
    studio::topology::assert_manifold(mesh, "the mesh");
}

/// Volume that the mesh encloses.
pub fn volume(mesh: &Mesh) -> f64 {
    let corner = |v: u32| -> DVec3 { mesh.positions[v as usize].as_dvec3() };
    mesh.triangles.iter().map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))) / 6.0).sum()
}
