//! For vertices of a mesh, the nearest vertices of the mesh of another frame, in space and colour.

use super::{
    moves::Moves,
    params::LevelParams,
    target::{Target, luma},
};
use crate::{executor::Executor, neighbour_grid::NeighbourGrid};
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Vertices that one job of an executor looks up.
const SAMPLES_PER_JOB: usize = 256;
/// Smallest cosine between the normals of a vertex and of its nearest one.
const SAME_SIDE: f32 = 0.4;
/// A vertex counts half if it is this share of the search's radius away from the tangent plane.
const FAR: f32 = 0.25;

/// A vertex and the tangent plane that it should come onto.
#[derive(Clone, Copy)]
pub(super) struct Pull {
    /// Where the vertex is before any motion.
    pub from: Vec3,
    pub position: Vec3,
    pub normal: Vec3,
    /// Gradient of luma along the surface, in grey levels per pixel, and the luma that is missing at `position`.
    pub gradient: Vec3,
    pub difference: f32,
    pub weight: f32,
}

/// The search of one level.
pub(super) struct Search<'a> {
    own: &'a Target<'a>,
    target: &'a Target<'a>,
    level: &'a LevelParams,
    /// The degree to which colours are smoothed, and the gradients of the other mesh's luma then.
    degree: usize,
    gradients: Vec<Vec3>,
    grid: NeighbourGrid,
}

impl<'a> Search<'a> {
    pub fn new(
        own: &'a Target<'a>,
        target: &'a Target<'a>,
        degree: usize,
        level: &'a LevelParams,
        executor: &dyn Executor,
    ) -> Self {
        let gradients = target.gradients(degree, executor);
        let grid = target.grid(level.target_stride as usize, 0.5 * level.search_pixels);
        Self { own, target, level, degree, gradients, grid }
    }

    /// For every `stride`th vertex, what it is pulled to, if anything is near.
    pub fn pulls(&self, moves: &Moves, executor: &dyn Executor) -> Vec<Option<Pull>> {
        let stride = self.level.stride as usize;
        let mut pulls = vec![None; self.own.positions.len().div_ceil(stride)];
        executor.map_parts(pulls.chunks_mut(SAMPLES_PER_JOB), |part, pulls| {
            for (i, pull) in (part * SAMPLES_PER_JOB..).zip(pulls) {
                *pull = self.pull(i * stride, moves);
            }
        });
        pulls
    }

    fn pull(&self, v: usize, moves: &Moves) -> Option<Pull> {
        let Self { own, target, degree, level, .. } = self;
        let from = own.positions[v];
        let p = moves.position(v, from);
        let normal = (moves.rotation(v) * own.mesh.normals[v].as_dvec3()).as_vec3();
        let colour = own.colours[*degree][v];
        let (mut best, mut least) = (None, level.search_pixels * level.search_pixels);
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
        let far = distance / (FAR * level.search_pixels);
        Some(Pull {
            from,
            position: target.positions[u],
            normal: target.mesh.normals[u],
            gradient: self.gradients[u],
            difference: luma(colour) - luma(target.colours[*degree][u]),
            weight: 1.0 / (1.0 + far * far),
        })
    }
}
