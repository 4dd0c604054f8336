//! Cuts a surface into charts: connected parts that face one way, so that a parallel projection unfolds them with
//! little stretch.
//!
//! Each triangle is labelled with one of six directions, those of the axes. A triangle prefers the direction that it
//! faces and the labels of its neighbours, which makes borders short. Connected triangles of one label are a chart.

use super::adjacency::NONE;
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Rounds of relabelling. Later rounds change next to nothing.
const ROUNDS: usize = 12;
/// How much a neighbour's label counts against facing the label's direction.
const AGREEMENT: f32 = 0.35;
/// A triangle takes a label only if the cosine of the angle to its direction exceeds this, so that its stretch is at
/// most the inverse.
pub(super) const LEAST_FACING: f32 = 0.35;

/// Directions of the labels.
const DIRECTIONS: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

/// A connected part of the surface.
#[derive(Debug)]
pub(super) struct Chart {
    /// Its triangles, each next to one that comes before it.
    pub triangles: Vec<u32>,
    /// The direction of projection. All triangles face it.
    pub axis: Vec3,
}

/// Cuts a surface into charts. `normals` are those of the triangles, with the length of their areas.
pub(super) fn charts(normals: &[Vec3], neighbours: &[[u32; 3]]) -> Vec<Chart> {
    let units: Vec<Vec3> = normals.iter().copied().map(unit).collect();
    let labels = labels(&units, neighbours);
    let all = (0..normals.len() as u32).collect::<Vec<_>>();
    let same_label = |a: u32, b: u32| labels[a as usize] == labels[b as usize];
    let parts = connected(&all, neighbours, &mut vec![false; normals.len()], same_label);
    parts.into_iter().map(|triangles| Chart::new(triangles, &labels, normals, &units)).collect()
}

impl Chart {
    fn new(triangles: Vec<u32>, labels: &[u8], normals: &[Vec3], units: &[Vec3]) -> Self {
        let direction = DIRECTIONS[usize::from(labels[triangles[0] as usize])];
        // The mean direction stretches least, but only the label's direction is certain to be faced by all.
        let mean = unit(triangles.iter().map(|&t| normals[t as usize]).sum());
        let faced = triangles.iter().all(|&t| units[t as usize].dot(mean) >= LEAST_FACING);
        Self { triangles, axis: if faced { mean } else { direction } }
    }
}

/// The vector with unit length, or zero.
fn unit(v: Vec3) -> Vec3 {
    let length = libm::sqrtf(v.length_squared());
    if length > 0.0 { v / length } else { Vec3::ZERO }
}

/// A label per triangle, from the triangles' unit normals.
fn labels(units: &[Vec3], neighbours: &[[u32; 3]]) -> Vec<u8> {
    let facing = |t: usize| DIRECTIONS.map(|direction| units[t].dot(direction));
    // Of equal scores the first counts.
    let best = |scores: [f32; 6]| (1..6).fold(0, |best, i| if scores[i] > scores[best] { i } else { best }) as u8;
    let mut labels: Vec<u8> = (0..units.len()).map(|t| best(facing(t))).collect();
    for _ in 0..ROUNDS {
        let mut changed = false;
        for t in 0..labels.len() {
            let mut agreeing = [0.0; 6];
            for &n in neighbours[t].iter().filter(|&&n| n != NONE) {
                agreeing[usize::from(labels[n as usize])] += AGREEMENT;
            }
            let mut scores = facing(t);
            for (score, agreeing) in scores.iter_mut().zip(agreeing) {
                *score += if *score > LEAST_FACING { agreeing } else { -2.0 };
            }
            let label = best(scores);
            changed |= label != labels[t];
            labels[t] = label;
        }
        if !changed {
            break;
        }
    }
    labels
}

/// The connected parts of some triangles, where only pairs that `joined` accepts are connected. Parts are in the order
/// of their first triangle. The triangles of a part are in the order in which they are reached from it. `waiting` has a flag
/// per triangle of the mesh; all are false before and after.
pub(super) fn connected(
    triangles: &[u32],
    neighbours: &[[u32; 3]],
    waiting: &mut [bool],
    joined: impl Fn(u32, u32) -> bool,
) -> Vec<Vec<u32>> {
    triangles.iter().for_each(|&t| waiting[t as usize] = true);
    let mut parts = Vec::new();
    for &first in triangles {
        if !waiting[first as usize] {
            continue;
        }
        waiting[first as usize] = false;
        let mut part = vec![first];
        let mut at = 0;
        while at < part.len() {
            let t = part[at];
            for &n in neighbours[t as usize].iter().filter(|&&n| n != NONE) {
                if waiting[n as usize] && joined(t, n) {
                    waiting[n as usize] = false;
                    part.push(n);
                }
            }
            at += 1;
        }
        parts.push(part);
    }
    parts
}
