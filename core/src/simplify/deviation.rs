//! The bound of the error: no vertex of the mesh as it was lies far from the triangles that replace it.

use alloc::{vec, vec::Vec};
use glam::{DVec3, Vec3};

use super::topology::{NONE, Topology, next};

/// For each vertex that is left, the list of the vertices of the original mesh that became it.
pub(super) struct Deviation<'a> {
    /// Positions in the original mesh.
    original: &'a [Vec3],
    /// The next vertex of the same list.
    following: Vec<u32>,
    /// The last vertex of the list that starts with each vertex that is left.
    last: Vec<u32>,
    /// Square of the largest distance, in scene units.
    bound: f64,
}

impl<'a> Deviation<'a> {
    pub(super) fn new(original: &'a [Vec3], bound: f32) -> Self {
        let bound = f64::from(bound);
        Self {
            original,
            following: vec![NONE; original.len()],
            last: (0..original.len() as u32).collect(),
            bound: bound * bound,
        }
    }

    /// The vertices that became a vertex.
    fn list(&self, v: u32) -> impl Iterator<Item = DVec3> + '_ {
        let mut at = v;
        core::iter::from_fn(move || {
            let here = self.original.get(at as usize)?;
            at = self.following[at as usize];
            Some(here.as_dvec3())
        })
    }

    /// Appends the list of the vertex `v` to that of `u`.
    pub(super) fn merge(&mut self, u: u32, v: u32) {
        self.following[self.last[u as usize] as usize] = v;
        self.last[u as usize] = self.last[v as usize];
    }

    /// Whether a vertex stands for more than itself.
    pub(super) fn has_merged(&self, v: u32) -> bool {
        self.following[v as usize] != NONE
    }

    /// Whether all original vertices around an edge stay near the surface if the edge becomes a vertex at `position`.
    pub(super) fn may_move(&self, edge: u32, position: Vec3, topology: &Topology, positions: &[Vec3]) -> bool {
        // Written so that a bound that is not a number lets nothing move.
        if self.bound == f64::INFINITY {
            return true;
        }
        let ends = [topology.start(edge), topology.end(edge)];
        let place = |w: u32| if ends.contains(&w) { position } else { positions[w as usize] }.as_dvec3();
        // Near a triangle around the vertex that it became.
        let near = |p: DVec3, w: u32| {
            let mut triangles = topology.fan(w).filter(|&h| !topology.is_beside(h, edge));
            triangles.any(|h| {
                let corners = [w, topology.end(h), topology.end(next(h))].map(place);
                squared_distance(p, corners) <= self.bound
            })
        };
        // The triangles around both ends will be those around the new vertex.
        let mut merged = ends.into_iter().flat_map(|end| self.list(end));
        let mut around = ends.into_iter().flat_map(|end| topology.fan(end)).map(|h| topology.end(h));
        merged.all(|p| ends.into_iter().any(|end| near(p, end)))
            && around.all(|w| ends.contains(&w) || topology.is_fixed(w) || self.list(w).all(|p| near(p, w)))
    }
}

/// Squared distance of a point from a triangle.
///
/// It is that from the plane if the point lies above the triangle, and that from the nearest edge otherwise.
fn squared_distance(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a);
    let inside = |a: DVec3, b: DVec3| (b - a).cross(p - a).dot(normal) >= 0.0;
    if inside(a, b) && inside(b, c) && inside(c, a) {
        let area = normal.length_squared();
        let height = (p - a).dot(normal);
        return if area > 0.0 { height * height / area } else { (p - a).length_squared() };
    }
    let to_edge = |a: DVec3, b: DVec3| {
        let (along, to) = (b - a, p - a);
        let t = (to.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        (to - along * t).length_squared()
    };
    to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_the_nearest_of_many_points() {
        let triangle = [DVec3::new(1.0, 0.0, 0.2), DVec3::new(3.0, 0.5, 0.0), DVec3::new(0.5, 2.0, 1.0)];
        let [a, b, c] = triangle;
        const STEPS: u32 = 200;
        for i in 0..64u32 {
            let p = DVec3::new(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16)) * 1.3 - 1.0;
            let shares = (0..=STEPS).flat_map(|s| (0..=STEPS - s).map(move |t| (s, t)));
            let points = shares.map(|(s, t)| a + (b - a) * (f64::from(s) / 200.0) + (c - a) * (f64::from(t) / 200.0));
            let nearest = points.map(|q| (p - q).length()).fold(f64::INFINITY, f64::min);
            let found = libm::sqrt(squared_distance(p, triangle));
            assert!(found <= nearest + 1e-12 && found > nearest - 0.02, "{p}: {found} for {nearest}");
        }
    }
}
