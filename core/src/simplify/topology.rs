//! The triangles of a mesh as half-edges, and the collapse of an edge.

use alloc::{vec, vec::Vec};

/// Stands for a half-edge or vertex that does not exist.
pub(super) const NONE: u32 = u32::MAX;

/// The triangles of a mesh as half-edges. Half-edge `3 t + k` runs from corner `k` of triangle `t` to the next corner. All
/// three of a triangle that was removed start at [`NONE`].
pub(super) struct Topology {
    /// The vertex at which each half-edge starts.
    from: Vec<u32>,
    /// The half-edge in the other direction, or [`NONE`] where the mesh is not a closed manifold.
    twin: Vec<u32>,
    /// A half-edge that starts at each vertex, or [`NONE`] for a vertex that must stay as it is: no triangle uses it, or the
    /// mesh is not a closed manifold there.
    out: Vec<u32>,
    /// The last search that met each vertex, and the number of searches.
    met: Vec<u32>,
    searches: u32,
    /// Triangles that are left.
    triangles: u32,
}

/// The half-edge after `h` in its triangle.
#[inline]
pub(super) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` in its triangle.
#[inline]
pub(super) fn previous(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl Topology {
    /// Connects the triangles of a mesh with a number of vertices.
    pub(super) fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let from = triangles.as_flattened().to_vec();
        let mut topology = Self {
            twin: vec![NONE; from.len()],
            out: vec![NONE; vertices],
            met: vec![0; vertices],
            searches: 0,
            triangles: triangles.len() as u32,
            from,
        };
        topology.pair();
        topology.fix_what_is_not_manifold();
        topology
    }

    /// Finds the twins: half-edges are sorted by the vertex at which they start.
    fn pair(&mut self) {
        let mut starts = vec![0u32; self.out.len() + 1];
        for &v in &self.from {
            starts[v as usize + 1] += 1;
        }
        for v in 0..self.out.len() {
            starts[v + 1] += starts[v];
        }
        let mut sorted = vec![0u32; self.from.len()];
        let mut at = starts.clone();
        for (h, &v) in self.from.iter().enumerate() {
            sorted[at[v as usize] as usize] = h as u32;
            at[v as usize] += 1;
        }
        let outgoing = |v: u32| &sorted[starts[v as usize] as usize..starts[v as usize + 1] as usize];
        for h in 0..self.from.len() as u32 {
            let (a, b) = (self.start(h), self.end(h));
            let mut back = outgoing(b).iter().filter(|&&o| self.end(o) == a);
            // An edge that more than two triangles share has no twins.
            let alone = outgoing(a).iter().filter(|&&o| self.end(o) == b).count() == 1;
            if let (Some(&twin), None, true) = (back.next(), back.next(), alone && a != b) {
                self.twin[h as usize] = twin;
            }
        }
        for v in 0..self.out.len() {
            self.out[v] = outgoing(v as u32).first().copied().unwrap_or(NONE);
        }
    }

    /// Fixes the vertices at which edges are open or several fans of triangles meet.
    fn fix_what_is_not_manifold(&mut self) {
        for h in (0..self.from.len() as u32).filter(|&h| self.twin[h as usize] == NONE) {
            for v in [self.start(h), self.end(h)] {
                self.out[v as usize] = NONE;
            }
        }
        let mut leaving = vec![0u32; self.out.len()];
        for &v in &self.from {
            leaving[v as usize] += 1;
        }
        for v in 0..self.out.len() as u32 {
            if self.out[v as usize] != NONE && self.fan(v).count() as u32 != leaving[v as usize] {
                self.out[v as usize] = NONE;
            }
        }
    }

    /// Number of triangles that are left.
    pub(super) fn triangles(&self) -> u32 {
        self.triangles
    }

    /// The vertex at which a half-edge starts.
    #[inline]
    pub(super) fn start(&self, h: u32) -> u32 {
        self.from[h as usize]
    }

    /// The vertex at which a half-edge ends.
    #[inline]
    pub(super) fn end(&self, h: u32) -> u32 {
        self.from[next(h) as usize]
    }

    /// The name of a half-edge's edge: the smaller of its two half-edges.
    #[inline]
    pub(super) fn edge(&self, h: u32) -> u32 {
        h.min(self.twin[h as usize])
    }

    /// The edges that may collapse: both ends are movable.
    pub(super) fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.from.len() as u32)
            .filter(|&h| self.from[h as usize] != NONE && self.edge(h) == h && self.is_movable(h))
    }

    /// The edges that a collapse removes: the edge itself and the other two of either triangle.
    pub(super) fn sides(&self, h: u32) -> [u32; 5] {
        let back = self.twin[h as usize];
        [h, next(h), previous(h), next(back), previous(back)].map(|side| self.edge(side))
    }

    /// Whether both ends of an edge are inside a closed fan of triangles.
    pub(super) fn is_movable(&self, h: u32) -> bool {
        !self.is_fixed(self.start(h)) && !self.is_fixed(self.end(h))
    }

    /// Whether a vertex must stay as it is.
    pub(super) fn is_fixed(&self, v: u32) -> bool {
        self.out[v as usize] == NONE
    }

    /// The half-edges that start at a vertex, clockwise as seen from outside. Stops at an open edge.
    pub(super) fn fan(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.out[v as usize];
        let mut at = first;
        core::iter::from_fn(move || {
            let here = (at != NONE).then_some(at)?;
            at = self.twin[previous(here) as usize];
            if at == first {
                at = NONE;
            }
            Some(here)
        })
    }

    /// Whether a triangle that starts with half-edge `h` is one of the two at the edge `of`.
    #[inline]
    pub(super) fn is_beside(&self, h: u32, of: u32) -> bool {
        h / 3 == of / 3 || h / 3 == self.twin[of as usize] / 3
    }

    /// The vertex across a half-edge: the third corner of its triangle.
    #[inline]
    pub(super) fn across(&self, h: u32) -> u32 {
        self.start(previous(h))
    }

    /// The link condition (Dey et al., Topology preserving edge contraction, 1999): the surface stays a closed manifold of
    /// the same genus if the ends of an edge share no neighbours but the two across it, and if their part is more than a
    /// tetrahedron. Both ends must be movable.
    pub(super) fn may_collapse(&mut self, h: u32) -> bool {
        let back = self.twin[h as usize];
        self.searches += 1;
        let first = self.out[self.start(h) as usize];
        let mut at = first;
        loop {
            let neighbour = self.end(at) as usize;
            self.met[neighbour] = self.searches;
            at = self.twin[previous(at) as usize];
            if at == first {
                break;
            }
        }
        let shared = self.fan(self.end(h)).filter(|&o| self.met[self.end(o) as usize] == self.searches).count();
        // The triangles that would be glued to each other must not have the same corners.
        let distinct = |h: u32| {
            let [a, b] = [next(h), previous(h)].map(|side| self.across(self.twin[side as usize]));
            a != b
        };
        shared == 2 && distinct(h) && distinct(back)
    }

    /// Collapses an edge: its end becomes its start, and its two triangles go.
    pub(super) fn collapse(&mut self, h: u32) {
        let (u, v, back) = (self.start(h), self.end(h), self.twin[h as usize]);
        // All triangles around the end now meet at the start.
        let mut at = back;
        loop {
            self.from[at as usize] = u;
            at = self.twin[previous(at) as usize];
            if at == back {
                break;
            }
        }
        self.out[v as usize] = NONE;
        for side in [h, back] {
            // Glues the triangle's two neighbours to each other.
            let (from_across, to_across) = (self.twin[next(side) as usize], self.twin[previous(side) as usize]);
            self.twin[from_across as usize] = to_across;
            self.twin[to_across as usize] = from_across;
            let across = self.across(side) as usize;
            if self.out[across] != NONE {
                self.out[across] = from_across;
            }
            self.out[u as usize] = to_across;
        }
        for triangle in [h / 3, back / 3] {
            self.from[3 * triangle as usize..][..3].fill(NONE);
        }
        self.triangles -= 2;
    }

    /// New numbers of the vertices that triangles still use, in their order; [`NONE`] for the others.
    pub(super) fn names(&self) -> Vec<u32> {
        let mut names = vec![NONE; self.out.len()];
        for &v in self.from.iter().filter(|&&v| v != NONE) {
            names[v as usize] = 0;
        }
        for (number, name) in (0..).zip(names.iter_mut().filter(|name| **name != NONE)) {
            *name = number;
        }
        names
    }

    /// The triangles that are left, in their order.
    pub(super) fn into_triangles(mut self) -> Vec<[u32; 3]> {
        self.from.retain(|&v| v != NONE);
        self.from.as_chunks::<3>().0.to_vec()
    }
}
