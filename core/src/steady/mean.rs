//! The mean of a frame and its neighbours, vertex by vertex.

use super::{
    moves::Moves,
    target::{Target, VERTICES_PER_JOB},
};
use crate::{executor::Executor, point_cloud::Mesh};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Parameters of the mean. Lengths are in pixels of footprint, colours in grey levels.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MeanParams {
    /// Weight of a neighbour's surface where it is the same as the frame's own, whose weight is 1. With 1/2 and two neighbours
    /// the mean is the binomial filter, which shrinks tips less than equal weights do.
    pub share: f32,
    /// Weight of a neighbour's colour where it is the same as the frame's own.
    pub colour_share: f32,
    /// Distance between two surfaces from which on they are not averaged. Below it the weight falls smoothly.
    pub farthest_pixels: f32,
    /// Difference of two colours, as the length of a vector of three channels, from which on they are not averaged.
    pub farthest_colour: f32,
}

impl MeanParams {
    /// The measured values.
    pub const DEFAULT: Self = Self { share: 0.5, colour_share: 1.0, farthest_pixels: 1.5, farthest_colour: 90.0 };
}

/// Distance along the surface, in pixels, within which a vertex of the other mesh is looked for.
const SEARCH: f32 = 4.0;
/// Smallest cosine between the normals of two places that are averaged.
const SAME_SIDE: f32 = 0.6;

/// What the neighbours say about one vertex.
#[derive(Clone, Copy, Default)]
struct Sum {
    /// Weighted sums of distances along the normal, of normals, and of the weights.
    offset: f32,
    normal: Vec3,
    weight: f32,
    /// Weighted sum of the differences of colours, and of the weights.
    colour: Vec3,
    colour_weight: f32,
}

/// The sums of all vertices.
pub(super) struct Means(Vec<Sum>);

impl Means {
    pub fn new(own: &Target) -> Self {
        Self(vec![Sum::default(); own.positions.len()])
    }

    /// Adds what the mesh of a neighbouring frame says, to which `moves` take the vertices.
    pub fn add(&mut self, own: &Target, moves: &Moves, target: &Target, params: &MeanParams, executor: &dyn Executor) {
        let grid = target.grid(1, SEARCH);
        executor.map_parts(self.0.chunks_mut(VERTICES_PER_JOB), |part, sums| {
            for (v, sum) in (part * VERTICES_PER_JOB..).zip(sums) {
                let p = moves.position(v, own.positions[v]);
                let rotation = moves.rotation(v);
                let normal = (rotation * own.mesh.normals[v].as_dvec3()).as_vec3();
                let (mut best, mut least) = (None, SEARCH * SEARCH);
                grid.near(p, SEARCH, |u| {
                    let distance = target.positions[u].distance_squared(p);
                    if distance < least && target.mesh.normals[u].dot(normal) > SAME_SIDE {
                        (best, least) = (Some(u), distance);
                    }
                });
                let Some(u) = best else { continue };
                let place = target.nearest_around(u as u32, p);
                let offset = (place.position - p).dot(normal);
                let agreement = falling(offset / params.farthest_pixels);
                let weight = params.share * agreement;
                sum.offset += weight * offset;
                sum.weight += weight;
                sum.normal += (rotation.transpose() * place.normal.as_dvec3()).as_vec3() * weight;
                let own_colour = Vec3::from_array(own.mesh.colours[v].map(f32::from));
                let difference = place.colour - own_colour;
                let weight = params.colour_share * agreement * falling(difference.length() / params.farthest_colour);
                sum.colour += difference * weight;
                sum.colour_weight += weight;
            }
        });
    }

    /// Moves the vertices to the mean, which has the frame itself with weight 1, and gives them its normal and colour.
    pub fn apply(self, mesh: &mut Mesh, footprint: f32) {
        for (v, sum) in self.0.into_iter().enumerate() {
            if sum.weight == 0.0 {
                continue;
            }
            let normal = mesh.normals[v];
            mesh.positions[v] += normal * (footprint * sum.offset / (1.0 + sum.weight));
            mesh.normals[v] = (normal + sum.normal).normalize_or(normal);
            let change = sum.colour / (1.0 + sum.colour_weight);
            let own = Vec3::from_array(mesh.colours[v].map(f32::from));
            mesh.colours[v] = (own + change).to_array().map(|c| libm::roundf(c.clamp(0.0, 255.0)) as u8);
        }
    }
}

/// 1 at zero, and falls smoothly to 0 at one.
fn falling(x: f32) -> f32 {
    let rest = 1.0 - x * x;
    if rest > 0.0 { rest * rest } else { 0.0 }
}
