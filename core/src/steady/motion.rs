//! The motion of a mesh's nodes to the mesh of another frame: non-rigid registration from coarse to fine.
//!
//! Each iteration looks up, for some vertices, the nearest vertex of the other mesh in space and colour (`search`), and moves
//! all nodes such that vertices come onto the tangent planes of these and onto the same luma there (Park et al., Colored point
//! cloud registration revisited, 2017), while adjacent nodes move alike (`system`).

use super::{
    moves::{Motion, Moves},
    nodes::{Groups, Nodes},
    params::MotionParams,
    search::{Pull, Search},
    system::{Block, System},
    target::{DEGREES, Target},
};
use crate::executor::Executor;
use alloc::{vec, vec::Vec};
use glam::DVec3;

/// The motions of all nodes of a mesh to the mesh of another frame.
pub(super) fn motions(
    own: &Target,
    nodes: &Nodes,
    target: &Target,
    params: &MotionParams,
    executor: &dyn Executor,
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
