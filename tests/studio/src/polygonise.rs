//! Ground truth as a triangle mesh, by marching tetrahedra. It is simple, slow and independent of the core's meshing.

use crate::{mesh::TriangleMesh, solid::Solid};
use glam::DVec3;
use std::collections::BTreeMap;

/// Cells along a side of a block. Blocks far from the surface are skipped as a whole.
const BLOCK: i32 = 8;

/// The six tetrahedra of a cube around its main diagonal, as corners (bit 0 is +x, bit 1 is +y, bit 2 is +z). Neighbouring
/// cubes divide their common face in the same way.
const TETRAHEDRA: [[usize; 4]; 6] =
    [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];

/// The surface of a solid on a grid of the given spacing. The mesh is closed and manifold, and its vertices lie on the
/// surface.
pub fn polygonise(solid: &Solid, spacing: f64) -> TriangleMesh {
    let (centre, radius) = solid.ball();
    let blocks = libm::ceil((radius + 2.0 * spacing) / (spacing * f64::from(BLOCK))) as i32;
    let mut mesher = Mesher { solid, centre, spacing, made: BTreeMap::new(), mesh: TriangleMesh::default() };
    for z in -blocks..blocks {
        for y in -blocks..blocks {
            for x in -blocks..blocks {
                mesher.block([x * BLOCK, y * BLOCK, z * BLOCK]);
            }
        }
    }
    mesher.mesh
}

struct Mesher<'a> {
    solid: &'a Solid,
    centre: DVec3,
    spacing: f64,
    /// Vertices so far, by the ends of their edges.
    made: BTreeMap<([i32; 3], [i32; 3]), u32>,
    mesh: TriangleMesh,
}

impl Mesher<'_> {
    fn position(&self, [x, y, z]: [i32; 3]) -> DVec3 {
        self.centre + DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * self.spacing
    }

    fn bound(&self, p: DVec3) -> f64 {
        self.solid.bound(p, self.solid.all())
    }

    fn block(&mut self, base: [i32; 3]) {
        let half = 0.5 * f64::from(BLOCK) * self.spacing;
        let middle = self.position(base) + DVec3::splat(half);
        if libm::fabs(self.bound(middle)) > half * libm::sqrt(3.0) {
            return;
        }
        let side = BLOCK + 1;
        let node = |i: i32| [base[0] + i % side, base[1] + i / side % side, base[2] + i / (side * side)];
        let values: Vec<f64> = (0..side * side * side).map(|i| self.bound(self.position(node(i)))).collect();
        for z in 0..BLOCK {
            for y in 0..BLOCK {
                for x in 0..BLOCK {
                    let corner = |c: usize| {
                        let c = c as i32;
                        ((z + (c >> 2)) * side + y + (c >> 1 & 1)) * side + x + (c & 1)
                    };
                    for tetrahedron in TETRAHEDRA {
                        let corners = tetrahedron.map(|c| (node(corner(c)), values[corner(c) as usize]));
                        self.tetrahedron(corners);
                    }
                }
            }
        }
    }

    fn tetrahedron(&mut self, corners: [([i32; 3], f64); 4]) {
        let (mut inside, mut outside) = (Vec::with_capacity(4), Vec::with_capacity(4));
        for corner in corners {
            if corner.1 < 0.0 { inside.push(corner.0) } else { outside.push(corner.0) }
        }
        let polygon: Vec<([i32; 3], [i32; 3])> = match (inside.as_slice(), outside.as_slice()) {
            (&[a], &[b, c, d]) => vec![(a, b), (a, c), (a, d)],
            (&[b, c, d], &[a]) => vec![(b, a), (c, a), (d, a)],
            (&[a, b], &[c, d]) => vec![(a, c), (a, d), (b, d), (b, c)],
            _ => return,
        };
        let sum = |nodes: &[[i32; 3]]| nodes.iter().map(|&n| self.position(n)).sum::<DVec3>() / nodes.len() as f64;
        let outward = sum(&outside) - sum(&inside);
        // The midpoints of the cut edges have the same orientation as the vertices on them.
        let at: Vec<DVec3> = polygon.iter().map(|&(a, b)| 0.5 * (self.position(a) + self.position(b))).collect();
        let flipped = (at[1] - at[0]).cross(at[2] - at[0]).dot(outward) < 0.0;
        let vertices: Vec<u32> = polygon.iter().map(|&(a, b)| self.vertex(a, b)).collect();
        for i in 2..vertices.len() {
            let (b, c) = if flipped { (i, i - 1) } else { (i - 1, i) };
            self.mesh.faces.push([vertices[0], vertices[b], vertices[c]]);
        }
    }

    /// The vertex where the surface crosses the edge between an inner and an outer node.
    fn vertex(&mut self, inside: [i32; 3], outside: [i32; 3]) -> u32 {
        if let Some(&vertex) = self.made.get(&(inside, outside)) {
            return vertex;
        }
        let (mut a, mut b) = (self.position(inside), self.position(outside));
        for _ in 0..20 {
            let middle = 0.5 * (a + b);
            if self.bound(middle) < 0.0 { a = middle } else { b = middle }
        }
        let vertex = self.mesh.vertices.len() as u32;
        self.mesh.vertices.push(0.5 * (a + b));
        self.made.insert((inside, outside), vertex);
        vertex
    }
}
