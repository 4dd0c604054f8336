//! The motion of a mesh's nodes to the mesh of another frame: non-rigid registration from coarse to fine.
//!
//! Each iteration looks up, for some vertices, the nearest vertex of the other mesh in space and colour (`search`), and moves
//! all nodes such that vertices come onto the tangent planes of these and onto the same luma there (Park et al., Colored point
//! cloud registration revisited, 2017), while adjacent nodes move alike (`system`).

use super::{
    nodes::{Groups, Nodes},
    search::{Pull, Search},
    system::{Block, System},
    target::{DEGREES, Target},
};
use crate::executor::Executor;
use alloc::{vec, vec::Vec};
use glam::{DMat3, DVec3, Vec3};

/// Parameters of the motion between two frames. Lengths are in pixels of footprint, colours in grey levels.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MotionParams {
    /// Distance of the nodes. Details that are smaller are averaged.
    pub node_pixels: f32,
    /// Motion below which a node is taken to be at rest, softly.
    pub rest_pixels: f32,
    /// How strongly nodes at rest are held: 1 is as strongly as the vertices around them pull.
    pub rest: f32,
    /// From coarse to fine.
    pub levels: [LevelParams; DEGREES],
}

/// Parameters of one level of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct LevelParams {
    /// Largest distance between a vertex and its nearest vertex of the other mesh.
    pub search_pixels: f32,
    /// Every how many vertices one is laid onto the other mesh.
    pub stride: u32,
    /// Every how many vertices one of the other mesh is considered.
    pub target_stride: u32,
    /// A difference in colour of one grey level counts like this distance in the search.
    pub colour_pixels: f32,
    /// A difference in luma of one grey level counts like this distance from the tangent plane.
    pub luma_pixels: f32,
    /// How strongly adjacent nodes move alike: 1 is as strongly as the vertices around them pull.
    pub stiffness: f32,
    /// Number of iterations.
    pub iterations: u32,
}

impl MotionParams {
    /// The measured values.
    pub const DEFAULT: Self = Self {
        node_pixels: 16.0,
        rest_pixels: 0.12,
        rest: 4.0,
        levels: [
            LevelParams {
                search_pixels: 40.0,
                stride: 24,
                target_stride: 12,
                colour_pixels: 0.2,
                luma_pixels: 0.02,
                stiffness: 4.0,
                iterations: 8,
            },
            LevelParams {
                search_pixels: 12.0,
                stride: 12,
                target_stride: 4,
                colour_pixels: 0.1,
                luma_pixels: 0.03,
                stiffness: 1.0,
                iterations: 6,
            },
            LevelParams {
                search_pixels: 4.0,
                stride: 6,
                target_stride: 1,
                colour_pixels: 0.05,
                luma_pixels: 0.05,
                stiffness: 0.3,
                iterations: 4,
            },
        ],
    };
}

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

/// The motions of all nodes of a mesh to the mesh of another frame.
pub(super) fn motions(
    own: &Target,
    nodes: &Nodes,
    target: &Target,
    params: &MotionParams,
    executor: &impl Executor,
) -> Vec<Motion> {
    let mut motions = vec![Motion::REST; nodes.places.len()];
    for (k, level) in params.levels.iter().enumerate() {
        let (degree, is_finest) = (DEGREES - 1 - k, k + 1 == DEGREES);
        let search = Search::new(own, target, degree, level, executor);
        let groups = Groups::new(nodes, level.stride as usize);
        for _ in 0..level.iterations {
            let moves = Moves { nodes, motions: &motions };
            let pulls = search.pulls(&moves, executor);
            let blocks = executor.map(nodes.places.len(), |node| {
                let mut block = Block::default();
                for &(sample, share) in groups.of(node) {
                    if let Some(pull) = &pulls[sample as usize] {
                        block.count += f64::from(share);
                        moves.add(&mut block, node, pull, f64::from(share), f64::from(level.luma_pixels));
                    }
                }
                block.normalise();
                // Not earlier, because all nodes start at rest.
                if is_finest {
                    hold(&mut block, &motions[node], params);
                }
                block
            });
            let system = System { nodes, motions: &motions, blocks: &blocks, stiffness: f64::from(level.stiffness) };
            let steps = system.solve();
            for (motion, step) in motions.iter_mut().zip(steps) {
                *motion = motion.followed_by(DVec3::from_slice(&step[..3]), DVec3::from_slice(&step[3..]));
            }
        }
    }
    motions
}

/// Difference in luma from which on two places hardly pull each other: another material has any luma.
const SAME_LUMA: f64 = 20.0;

impl Moves<'_> {
    /// Adds the equations of a pull on a node: distance from the tangent plane, and luma.
    fn add(&self, block: &mut Block, node: usize, pull: &Pull, share: f64, luma_pixels: f64) {
        let (place, motion) = (self.nodes.places[node], &self.motions[node]);
        let p = motion.apply(place, pull.from);
        let arm = p.as_dvec3() - (place.as_dvec3() + motion.translation);
        let to = (pull.position - p).as_dvec3();
        let weight = share * f64::from(pull.weight);
        let normal = pull.normal.as_dvec3();
        block.add(arm.cross(normal), normal, normal.dot(to), weight);
        let gradient = pull.gradient.as_dvec3() * luma_pixels;
        let missing = luma_pixels * f64::from(pull.difference) + gradient.dot(to);
        let far = missing / (luma_pixels * SAME_LUMA);
        block.add(arm.cross(gradient), gradient, missing, weight / (1.0 + far * far));
    }
}

/// Holds a node that hardly moves.
fn hold(block: &mut Block, motion: &Motion, params: &MotionParams) {
    let far = motion.translation.length_squared() / f64::from(params.rest_pixels * params.rest_pixels);
    let weight = f64::from(params.rest) / ((1.0 + far) * (1.0 + far));
    for axis in DVec3::AXES {
        block.add(DVec3::ZERO, axis, -motion.translation.dot(axis), weight);
    }
}
