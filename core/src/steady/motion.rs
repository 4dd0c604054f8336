//! The motion of a mesh's nodes to the mesh of another frame: non-rigid registration from coarse to fine.
//!
//! Each iteration looks up, for some vertices, the nearest vertex of the other mesh in space and colour, and moves all nodes
//! such that vertices come onto the tangent planes of these and onto the same luma there (Park et al., Colored point cloud
//! registration revisited, 2017), while adjacent nodes move alike.

use super::{
    nodes::{NODES_PER_VERTEX, Nodes},
    system::{Block, System},
    target::{DEGREES, Target, luma},
};
use crate::{executor::Executor, neighbour_grid::NeighbourGrid};
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
        rest_pixels: 0.4,
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

/// One vertex and the tangent plane that it should come onto.
#[derive(Clone, Copy)]
struct Pull {
    vertex: u32,
    position: Vec3,
    normal: Vec3,
    /// Gradient of luma along the surface, and the luma that is missing.
    gradient: Vec3,
    difference: f32,
    weight: f32,
}

/// The motions of all nodes.
pub(super) fn motions(
    own: &Target,
    nodes: &Nodes,
    target: &Target,
    params: &MotionParams,
    executor: &impl Executor,
) -> Vec<Motion> {
    let mut motions = vec![Motion::REST; nodes.places.len()];
    for (k, level) in params.levels.iter().enumerate() {
        let degree = DEGREES - 1 - k;
        let search = Search {
            own,
            nodes,
            target,
            degree,
            gradients: &target.gradients(degree, executor),
            grid: &target.grid(level.target_stride as usize, level.search_pixels / 2.0),
            level,
        };
        let groups = groups(nodes, level.stride as usize);
        for _ in 0..level.iterations {
            let pulls = search.pulls(&motions, executor);
            let blocks = executor.map(nodes.places.len(), |node| {
                let mut block = Block::default();
                for &(sample, share) in groups.of(node) {
                    let Some(pull) = &pulls[sample as usize] else { continue };
                    block.count += f64::from(share);
                    add(&mut block, own, nodes, &motions, node, pull, share, level.luma_pixels);
                }
                block.normalise();
                if degree == 0 {
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

/// Adds the equations of one pull on a node: distance from the tangent plane, and luma.
#[allow(clippy::too_many_arguments)]
fn add(
    block: &mut Block,
    own: &Target,
    nodes: &Nodes,
    motions: &[Motion],
    node: usize,
    pull: &Pull,
    share: f32,
    luma_pixels: f32,
) {
    let place = nodes.places[node];
    let p = motions[node].apply(place, own.positions[pull.vertex as usize]);
    let arm = p.as_dvec3() - (place.as_dvec3() + motions[node].translation);
    let to = (pull.position - p).as_dvec3();
    let weight = f64::from(share * pull.weight);
    let normal = pull.normal.as_dvec3();
    block.add(arm.cross(normal), normal, normal.dot(to), weight);
    let gradient = pull.gradient.as_dvec3() * f64::from(luma_pixels);
    let missing = f64::from(luma_pixels * pull.difference) + gradient.dot(to);
    // Cauchy's weight: another material has any luma.
    let far = missing / (f64::from(luma_pixels) * 20.0);
    block.add(arm.cross(gradient), gradient, missing, weight / (1.0 + far * far));
}

/// Holds a node that hardly moves.
fn hold(block: &mut Block, motion: &Motion, params: &MotionParams) {
    let far = motion.translation.length_squared() / f64::from(params.rest_pixels * params.rest_pixels);
    let weight = f64::from(params.rest) / ((1.0 + far) * (1.0 + far));
    for axis in DVec3::AXES {
        block.add(DVec3::ZERO, axis, -motion.translation.dot(axis), weight);
    }
}

/// The samples that each node moves.
struct Groups {
    starts: Vec<u32>,
    /// Index of the sample, and the node's share in it.
    list: Vec<(u32, f32)>,
}

impl Groups {
    fn of(&self, node: usize) -> &[(u32, f32)] {
        &self.list[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}

/// Sorts every `stride`th vertex by the nodes that move it.
fn groups(nodes: &Nodes, stride: usize) -> Groups {
    let samples = nodes.shares.iter().step_by(stride).enumerate();
    let all = samples.flat_map(|(i, shares)| (0..NODES_PER_VERTEX).map(move |k| (i, shares[k])));
    let all = all.filter(|&(_, (_, share))| share > 0.0);
    let mut starts = vec![0u32; nodes.places.len() + 1];
    for (_, (node, _)) in all.clone() {
        starts[node as usize + 1] += 1;
    }
    for n in 0..nodes.places.len() {
        starts[n + 1] += starts[n];
    }
    let mut list = vec![(0, 0.0); starts[nodes.places.len()] as usize];
    let mut next = starts.clone();
    for (i, (node, share)) in all {
        let at = &mut next[node as usize];
        list[*at as usize] = (i as u32, share);
        *at += 1;
    }
    Groups { starts, list }
}

/// What the search for nearest vertices needs.
struct Search<'a> {
    own: &'a Target<'a>,
    nodes: &'a Nodes,
    target: &'a Target<'a>,
    degree: usize,
    gradients: &'a [Vec3],
    grid: &'a NeighbourGrid,
    level: &'a LevelParams,
}

/// Vertices that one job of an executor looks up.
const SAMPLES_PER_JOB: usize = 256;
/// Smallest cosine between the normals of a vertex and of its nearest one.
const SAME_SIDE: f32 = 0.4;

impl Search<'_> {
    /// For every `stride`th vertex, what it is pulled to.
    fn pulls(&self, motions: &[Motion], executor: &impl Executor) -> Vec<Option<Pull>> {
        let stride = self.level.stride as usize;
        let mut pulls = vec![None; self.own.positions.len().div_ceil(stride)];
        executor.map_parts(pulls.chunks_mut(SAMPLES_PER_JOB), |part, pulls| {
            for (i, pull) in (part * SAMPLES_PER_JOB..).zip(pulls) {
                *pull = self.pull(i * stride, motions);
            }
        });
        pulls
    }

    fn pull(&self, v: usize, motions: &[Motion]) -> Option<Pull> {
        let Self { own, nodes, target, degree, level, .. } = self;
        let moves = Moves { nodes, motions };
        let p = moves.position(v, own.positions[v]);
        let normal = (moves.rotation(v) * own.mesh.normals[v].as_dvec3()).as_vec3();
        let colour = own.colours[*degree][v];
        let farthest = level.search_pixels * level.search_pixels;
        let (mut best, mut least) = (None, farthest);
        let stride = level.target_stride as usize;
        self.grid.near(p, level.search_pixels, |i| {
            let u = i * stride;
            let distance = target.positions[u].distance_squared(p);
            if distance >= least || target.mesh.normals[u].dot(normal) < SAME_SIDE {
                return;
            }
            let difference = target.colours[*degree][u].distance_squared(colour);
            let cost = distance + level.colour_pixels * level.colour_pixels * difference;
            if cost < least {
                (best, least) = (Some(u), cost);
            }
        });
        let u = best?;
        let distance = (target.positions[u] - p).dot(target.mesh.normals[u]);
        let far = 4.0 * distance / level.search_pixels;
        Some(Pull {
            vertex: v as u32,
            position: target.positions[u],
            normal: target.mesh.normals[u],
            gradient: self.gradients[u],
            difference: luma(colour) - luma(target.colours[*degree][u]),
            weight: 1.0 / (1.0 + far * far),
        })
    }
}
