//! Triangle meshes that the studio measures and writes.

use crate::{noise::Random, solid::Solid};
use glam::{DVec3, Vec3};
use pcmvs_core::Mesh;

/// A triangle mesh. Faces are counter-clockwise seen from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriangleMesh {
    /// Positions in the world, in metres.
    pub vertices: Vec<DVec3>,
    /// Indices of three vertices each.
    pub faces: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// A mesh of the core, whose positions are relative to its rig's origin.
    pub fn of_core(positions: &[Vec3], triangles: &[[u32; 3]], origin: DVec3) -> Self {
        Self { vertices: positions.iter().map(|p| p.as_dvec3() + origin).collect(), faces: triangles.to_vec() }
    }

    /// The corners of a face.
    pub fn corners(&self, face: usize) -> [DVec3; 3] {
        self.faces[face].map(|i| self.vertices[i as usize])
    }

    /// Points spread evenly over the surface. The same seed gives the same points.
    pub fn surface_points(&self, count: usize, seed: u64) -> Vec<DVec3> {
        let mut sum = 0.0;
        let area = |f: usize| {
            let [a, b, c] = self.corners(f);
            0.5 * (b - a).cross(c - a).length()
        };
        let areas: Vec<f64> = (0..self.faces.len())
            .map(|f| {
                sum += area(f);
                sum
            })
            .collect();
        let mut random = Random::new(seed, 2);
        (0..count)
            .map(|i| {
                let at = (i as f64 + random.uniform()) / count as f64 * sum;
                let face = areas.partition_point(|&upto| upto <= at).min(self.faces.len() - 1);
                let (mut u, mut v) = (random.uniform(), random.uniform());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let [a, b, c] = self.corners(face);
                a + (b - a) * u + (c - a) * v
            })
            .collect()
    }

    /// The mesh in the type of the core, relative to the world's origin, with the normals of the true surface.
    pub fn to_core(&self, truth: &Solid) -> Mesh {
        Mesh {
            positions: self.vertices.iter().map(|p| p.as_vec3()).collect(),
            normals: self.vertices.iter().map(|&p| truth.normal(p).as_vec3()).collect(),
            triangles: self.faces.clone(),
            ..Mesh::default()
        }
    }
}
