//! What the collapse of an edge costs, where its vertex goes, and whether it may happen.

use alloc::{vec, vec::Vec};
use glam::{DVec3, Vec3};

use super::{
    deviation::Deviation,
    params::SimplifyParams,
    quadric::{Quadric, Stored},
    topology::{Topology, next},
};
use crate::point_cloud::Mesh;

/// Cosine of the largest angle by which a collapse may turn a triangle.
const TURN: f64 = 0.5;
/// Roundness below which a triangle is a sliver. A collapse may make none, and none worse. A higher threshold blocks so many
/// cheap collapses around the slivers of marching cubes that the mesh gets worse, and more slivers are left.
const SLIVER: f64 = 0.02;

/// A mesh whose edges collapse one by one.
pub(super) struct Collapsing<'a> {
    pub(super) topology: Topology,
    /// In scene units.
    pub(super) positions: Vec<Vec3>,
    quadrics: Vec<Stored>,
    deviation: Deviation<'a>,
    /// Pixels of footprint per scene unit.
    scale: f64,
    /// Pixels of footprint per step of an sRGB channel; 0 if the mesh has no colours.
    colour_scale: f64,
}

/// The best collapse of an edge.
pub(super) struct Collapse {
    /// Where the vertex goes, in scene units.
    position: Vec3,
    /// The error: squared distance times area, in pixels of footprint.
    pub(super) cost: f32,
}

impl<'a> Collapsing<'a> {
    pub(super) fn new(mesh: &'a Mesh, params: &SimplifyParams) -> Self {
        let coloured = mesh.colours.len() == mesh.positions.len();
        let mut work = Self {
            topology: Topology::new(&mesh.triangles, mesh.positions.len()),
            positions: mesh.positions.clone(),
            quadrics: vec![Quadric::ZERO.into(); mesh.positions.len()],
            deviation: Deviation::new(&mesh.positions, params.footprint * params.error_pixels),
            scale: 1.0 / f64::from(params.footprint),
            colour_scale: if coloured { f64::from(params.colour_pixels) / 255.0 } else { 0.0 },
        };
        for triangle in &mesh.triangles {
            let first = work.position(triangle[0]);
            let corners = triangle.map(|v| (work.position(v) - first) * work.scale);
            // Relative to gray, so that less precision is lost.
            let length = |c: u8| (f64::from(c) - 128.0) * work.colour_scale;
            let colour = |v: u32| DVec3::from_array(mesh.colours[v as usize].map(length));
            let quadric = Quadric::of_triangle(corners, (work.colour_scale > 0.0).then(|| triangle.map(colour)));
            for (&v, at) in triangle.iter().zip(corners) {
                let stored = &mut work.quadrics[v as usize];
                *stored = Quadric::from(&*stored).plus(&quadric.relative_to(at).tethered()).into();
            }
        }
        work
    }

    fn position(&self, v: u32) -> DVec3 {
        self.positions[v as usize].as_dvec3()
    }

    /// The colour of least error of a vertex that collapses have moved.
    pub(super) fn colour(&self, v: u32) -> Option<[u8; 3]> {
        if !self.deviation.has_merged(v) || self.colour_scale == 0.0 {
            return None;
        }
        let colour = Quadric::from(&self.quadrics[v as usize]).colour_at_origin();
        Some((colour / self.colour_scale + 128.5).to_array().map(|c| c as u8))
    }

    /// The quadric of the vertex that an edge becomes, relative to the edge's start.
    fn merged(&self, edge: u32) -> Quadric {
        let ends = [self.topology.start(edge), self.topology.end(edge)];
        let [u, v] = ends.map(|v| Quadric::from(&self.quadrics[v as usize]));
        v.relative_to((self.position(ends[0]) - self.position(ends[1])) * self.scale).plus(&u)
    }

    /// The best collapse of an edge, whether it may happen or not.
    pub(super) fn best(&self, edge: u32) -> Option<Collapse> {
        let origin = self.position(self.topology.start(edge));
        let quadric = self.merged(edge).with_best_colours();
        let (along, at) = self.volume(edge, origin);
        let best = quadric.minimum(along, at)?;
        let cost = quadric.error(best);
        let position = (origin + best / self.scale).as_vec3();
        // Rounding can make an error of 0 negative.
        let cost = if cost < 0.0 { 0.0 } else { cost as f32 };
        (cost.is_finite() && position.is_finite()).then_some(Collapse { position, cost })
    }

    /// The plane on which the new vertex keeps the volume: positions x, relative to an origin and in pixels of footprint,
    /// with `along · x = at` (Lindstrom & Turk, Fast and memory efficient polygonal simplification, 1998).
    fn volume(&self, edge: u32, origin: DVec3) -> (DVec3, f64) {
        let (mut along, mut at) = (DVec3::ZERO, 0.0);
        let local = |v: u32| (self.position(v) - origin) * self.scale;
        let (start, end) = (self.topology.start(edge), self.topology.end(edge));
        for from in [start, end] {
            let apex = local(from);
            for h in self.topology.fan(from) {
                let goes = self.topology.is_beside(h, edge);
                if goes && from == end {
                    continue;
                }
                let [a, b] = [h, next(h)].map(|h| local(self.topology.end(h)));
                let cross = a.cross(b);
                at += apex.dot(cross);
                if !goes {
                    along += cross;
                }
            }
        }
        (along, at)
    }

    /// Collapses an edge unless that would do harm, and returns the vertex that it has become.
    pub(super) fn try_collapse(&mut self, edge: u32) -> Option<u32> {
        let position = self.best(edge)?.position;
        let sound = self.topology.may_collapse(edge)
            && self.keeps_shape(edge, position)
            && self.deviation.may_move(edge, position, &self.topology, &self.positions);
        if !sound {
            return None;
        }
        let (u, v) = (self.topology.start(edge), self.topology.end(edge));
        let moved = (position.as_dvec3() - self.position(u)) * self.scale;
        self.quadrics[u as usize] = self.merged(edge).relative_to(moved).into();
        self.positions[u as usize] = position;
        self.deviation.merge(u, v);
        self.topology.collapse(edge);
        Some(u)
    }

    /// Whether the triangles that a collapse moves keep their side and do not become slivers.
    fn keeps_shape(&self, edge: u32, position: Vec3) -> bool {
        let moved = position.as_dvec3();
        [self.topology.start(edge), self.topology.end(edge)].into_iter().all(|end| {
            let apex = self.position(end);
            let mut moving = self.topology.fan(end).filter(|&h| !self.topology.is_beside(h, edge));
            moving.all(|h| {
                let [a, b] = [h, next(h)].map(|h| self.position(self.topology.end(h)));
                Shape::new(moved, a, b).may_replace(&Shape::new(apex, a, b))
            })
        })
    }
}

/// A triangle's normal, with twice its area as length, and the sum of its squared edges.
struct Shape {
    normal: DVec3,
    edges: f64,
}

impl Shape {
    fn new(a: DVec3, b: DVec3, c: DVec3) -> Self {
        let (p, q) = (b - a, c - a);
        Self { normal: p.cross(q), edges: p.length_squared() + q.length_squared() + (c - b).length_squared() }
    }

    /// 1 for an equilateral triangle, 0 for one without area.
    fn roundness(&self) -> f64 {
        const EQUILATERAL: f64 = 3.464_101_615_137_754_6;
        EQUILATERAL * self.normal.length() / self.edges
    }

    fn may_replace(&self, before: &Self) -> bool {
        let least = TURN * before.normal.length() * self.normal.length();
        let roundness = self.roundness();
        roundness > 0.0
            && self.normal.dot(before.normal) >= least
            && (roundness > SLIVER || roundness >= before.roundness())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(apex: [f64; 3]) -> Shape {
        Shape::new(DVec3::from_array(apex), DVec3::ZERO, DVec3::X)
    }

    #[test]
    fn triangles_turn_by_at_most_sixty_degrees() {
        let flat = shape([0.5, 1.0, 0.0]);
        let (sine, cosine) = (libm::sin(1.0), libm::cos(1.0));
        assert!(shape([0.5, cosine, sine]).may_replace(&flat));
        let (sine, cosine) = (libm::sin(1.1), libm::cos(1.1));
        assert!(!shape([0.5, cosine, sine]).may_replace(&flat));
        assert!(!shape([0.5, -1.0, 0.0]).may_replace(&flat));
    }

    #[test]
    fn slivers_replace_only_worse_ones() {
        let [fine, thin, thinner, none] = [1.0, 0.005, 0.002, 0.0].map(|height| shape([0.5, height, 0.0]));
        assert!(fine.may_replace(&thin) && thin.may_replace(&thinner));
        assert!(!thin.may_replace(&fine) && !thinner.may_replace(&thin));
        assert!(fine.may_replace(&none) && !none.may_replace(&none));
    }
}
