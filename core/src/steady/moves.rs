//! Rigid motions of nodes, and what they move.

use super::nodes::Nodes;
use glam::{DMat3, DVec3, Vec3};

/// A rigid motion about a node's place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Motion {
    pub rotation: DMat3,
    pub translation: DVec3,
}

impl Motion {
    pub const REST: Self = Self { rotation: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Where a point near the node at `place` goes.
    pub fn apply(&self, place: Vec3, p: Vec3) -> Vec3 {
        (self.rotation * (p - place).as_dvec3() + place.as_dvec3() + self.translation).as_vec3()
    }

    /// The motion followed by a small turn about the node's place and a shift.
    pub fn followed_by(&self, turn: DVec3, shift: DVec3) -> Self {
        let rotation = small_rotation(turn) * self.rotation;
        Self { rotation, translation: self.translation + shift }
    }
}

/// The rotation about `w` by 2·atan(|w|/2), which is |w| for small angles (Cayley's formula: no transcendental function).
fn small_rotation(w: DVec3) -> DMat3 {
    let h = 0.5 * w;
    let cross = DMat3::from_cols(DVec3::new(0.0, h.z, -h.y), DVec3::new(-h.z, 0.0, h.x), DVec3::new(h.y, -h.x, 0.0));
    DMat3::IDENTITY + (cross + cross * cross) * (2.0 / (1.0 + h.length_squared()))
}

/// The motions of all nodes, and what they move.
pub(super) struct Moves<'a> {
    pub nodes: &'a Nodes,
    pub motions: &'a [Motion],
}

impl Moves<'_> {
    /// Where the vertex `v` at `position` goes.
    pub fn position(&self, v: usize, position: Vec3) -> Vec3 {
        let by = |&(node, weight): &(u32, f32)| {
            self.motions[node as usize].apply(self.nodes.places[node as usize], position) * weight
        };
        self.nodes.shares[v].iter().map(by).sum()
    }

    /// The rotation of the node that has the largest share in the vertex `v`.
    pub fn rotation(&self, v: usize) -> DMat3 {
        self.motions[self.nodes.shares[v][0].0 as usize].rotation
    }
}
