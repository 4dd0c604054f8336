//! The 256 cases of marching cubes (Lorensen & Cline, SIGGRAPH 1987), generated from one rule for the faces of the
//! cube.
//!
//! The original table leaves holes between ambiguous cases. Here each face decides by its own corners how the surface
//! crosses it, so that neighbouring cubes always agree.
//!
//! Corner c of a cube lies at (c & 1, c >> 1 & 1, c >> 2). An edge is given by its axis and its lower corner.

use alloc::vec::Vec;

/// Edges of a cube: axis and lower corner.
pub(super) const EDGES: [(usize, usize); 12] =
    [(0, 0), (0, 2), (0, 4), (0, 6), (1, 0), (1, 1), (1, 4), (1, 5), (2, 0), (2, 1), (2, 2), (2, 3)];

/// Triangles of all cases, as indices into [`EDGES`]. They are counter-clockwise as seen from outside the object.
pub(super) struct Cases {
    triangles: Vec<[u8; 3]>,
    first: [u16; 257],
}

impl Cases {
    pub(super) fn new() -> Self {
        let mut cases = Self { triangles: Vec::new(), first: [0; 257] };
        for signs in 0..256 {
            let next = segments(signs);
            let mut used = [false; 12];
            for start in 0..12 {
                if used[start] || next[start].is_none() {
                    continue;
                }
                let mut polygon = Vec::new();
                let mut edge = start;
                while !used[edge] {
                    used[edge] = true;
                    polygon.push(edge);
                    edge = next[edge].expect("the polygon continues at every crossed edge");
                }
                let found = triangulate(&polygon, 0, polygon.len() - 1, &mut cases.triangles);
                assert!(found, "every polygon has a triangulation without a diagonal in a face");
            }
            cases.first[signs + 1] = cases.triangles.len() as u16;
        }
        cases
    }

    /// Triangles of a case. Bit c of `signs` is set if corner c is inside.
    #[inline]
    pub(super) fn of(&self, signs: u8) -> &[[u8; 3]] {
        let i = usize::from(signs);
        &self.triangles[usize::from(self.first[i])..usize::from(self.first[i + 1])]
    }
}

/// Corners of a face, counter-clockwise as seen from outside the cube.
fn face(axis: usize, side: usize) -> [usize; 4] {
    let (a, b, c) = (side << axis, 1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
    if side == 1 { [a, a | b, a | b | c, a | c] } else { [a, a | c, a | b | c, a | b] }
}

/// Index of the edge between two neighbouring corners.
fn edge(a: usize, b: usize) -> usize {
    let axis = (a ^ b).trailing_zeros() as usize;
    EDGES.iter().position(|&e| e == (axis, a & b)).expect("corners are neighbours")
}

/// For each crossed edge, the edge that follows on its polygon.
///
/// The crossed edges of a face are joined so that each run of inside corners is cut off separately. On an ambiguous
/// face the two inside corners are therefore separated. The rule depends only on the corners of the face, so that the
/// cubes on both sides of it agree.
fn segments(signs: usize) -> [Option<usize>; 12] {
    let inside = |corner: usize| signs >> corner & 1 == 1;
    let mut next = [None; 12];
    for axis in 0..3 {
        for side in 0..2 {
            let corners = face(axis, side);
            for i in 0..4 {
                let (before, at) = (corners[i], corners[(i + 1) % 4]);
                if inside(before) || !inside(at) {
                    continue;
                }
                let mut last = i + 1;
                while inside(corners[(last + 1) % 4]) {
                    last += 1;
                }
                next[edge(before, at)] = Some(edge(corners[last % 4], corners[(last + 1) % 4]));
            }
        }
    }
    next
}

/// Triangulates a polygon from vertex `i` to vertex `j`, without diagonals that lie in a face of the cube. The
/// neighbouring cube could use the same diagonal, which would then be an edge of four triangles.
fn triangulate(polygon: &[usize], i: usize, j: usize, triangles: &mut Vec<[u8; 3]>) -> bool {
    if j < i + 2 {
        return true;
    }
    let allowed = |a: usize, b: usize| b == a + 1 || !share_face(polygon[a], polygon[b]);
    for k in i + 1..j {
        let len = triangles.len();
        if allowed(i, k)
            && allowed(k, j)
            && triangulate(polygon, i, k, triangles)
            && triangulate(polygon, k, j, triangles)
        {
            triangles.push([polygon[i] as u8, polygon[k] as u8, polygon[j] as u8]);
            return true;
        }
        triangles.truncate(len);
    }
    false
}

fn share_face(a: usize, b: usize) -> bool {
    let touches = |edge: usize, axis: usize, side: usize| {
        let (along, corner) = EDGES[edge];
        along != axis && corner >> axis & 1 == side
    };
    (0..3).any(|axis| (0..2).any(|side| touches(a, axis, side) && touches(b, axis, side)))
}
