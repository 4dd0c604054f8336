//! Nodes spread over a mesh, each of which moves its surroundings rigidly (Sumner et al., Embedded deformation for shape
//! manipulation, 2007).

use super::target::Target;
use crate::sort;
use alloc::{collections::BinaryHeap, vec, vec::Vec};
use core::cmp::Reverse;
use glam::Vec3;

/// Number of nodes that move a vertex.
const NODES_PER_VERTEX: usize = 4;

pub(super) struct Nodes {
    /// The places of the nodes, in pixels of footprint.
    pub places: Vec<Vec3>,
    /// Pairs of adjacent nodes, each listed once with the smaller index first.
    pub edges: Vec<[u32; 2]>,
    /// For each vertex, the nodes that move it and their weights. The weights add up to one, and may be zero.
    pub shares: Vec<[(u32, f32); NODES_PER_VERTEX]>,
}

impl Nodes {
    /// Nodes at a distance of about `spacing` pixels along the mesh, so that parts that only touch do not move each other.
    pub fn new(mesh: &Target, spacing: f32) -> Self {
        let (places, owners) = spread(mesh, spacing);
        // As numbers with the smaller index in the upper half, which are sorted like pairs.
        let mut edges: Vec<u64> = Vec::new();
        for triangle in &mesh.mesh.triangles {
            let [a, b, c] = triangle.map(|v| owners[v as usize]);
            let sides = [[a, b], [b, c], [c, a]].into_iter().filter(|[a, b]| a != b);
            edges.extend(sides.map(|[a, b]| u64::from(a.min(b)) << 32 | u64::from(a.max(b))));
        }
        sort::numbers(&mut edges);
        edges.dedup();
        let edges: Vec<[u32; 2]> = edges.into_iter().map(|key| [(key >> 32) as u32, key as u32]).collect();
        let mut adjacent = vec![Vec::new(); places.len()];
        for &[a, b] in &edges {
            adjacent[a as usize].push(b);
            adjacent[b as usize].push(a);
        }
        let share = |(&p, &owner): (&Vec3, &u32)| {
            // A node's influence ends at this distance.
            let reach = 1.5 * spacing;
            let mut best = [(owner, 0.0_f32); NODES_PER_VERTEX];
            best[0].1 = f32::MIN_POSITIVE;
            for node in adjacent[owner as usize].iter().copied().chain([owner]) {
                let near = 1.0 - p.distance_squared(places[node as usize]) / (reach * reach);
                let weight = if near > 0.0 { near * near } else { 0.0 };
                if let Some(at) = best.iter().position(|other| weight > other.1) {
                    best.copy_within(at..NODES_PER_VERTEX - 1, at + 1);
                    best[at] = (node, weight);
                }
            }
            let sum: f32 = best.iter().map(|&(_, weight)| weight).sum();
            best.map(|(node, weight)| (node, weight / sum))
        };
        let shares = mesh.positions.iter().zip(&owners).map(share).collect();
        Self { places, edges, shares }
    }
}

/// Places of nodes, and the node that is nearest to each vertex along edges. A vertex without a node within `spacing`
/// becomes a node, in the order of the vertices.
fn spread(mesh: &Target, spacing: f32) -> (Vec<Vec3>, Vec<u32>) {
    let count = mesh.positions.len();
    let (mut distances, mut owners) = (vec![f32::INFINITY; count], vec![0u32; count]);
    let mut places = Vec::new();
    let mut queue: BinaryHeap<Reverse<(u32, u32)>> = BinaryHeap::new();
    for v in 0..count {
        if distances[v] <= spacing {
            continue;
        }
        let node = places.len() as u32;
        places.push(mesh.positions[v]);
        (distances[v], owners[v]) = (0.0, node);
        queue.push(Reverse((0, v as u32)));
        while let Some(Reverse((distance, v))) = queue.pop() {
            // The bits of positive numbers sort like the numbers.
            let distance = f32::from_bits(distance);
            if distance > distances[v as usize] || owners[v as usize] != node {
                continue;
            }
            for &other in mesh.neighbours.of(v) {
                let other = other as usize;
                let further = distance + mesh.positions[v as usize].distance(mesh.positions[other]);
                if further < distances[other] && further <= 1.5 * spacing {
                    (distances[other], owners[other]) = (further, node);
                    queue.push(Reverse((further.to_bits(), other as u32)));
                }
            }
        }
    }
    (places, owners)
}

/// The samples that each node moves.
pub(super) struct Groups {
    starts: Vec<u32>,
    /// Index of the sample, and the node's share in it.
    list: Vec<(u32, f32)>,
}

impl Groups {
    /// Every `stride`th vertex is a sample.
    pub fn new(nodes: &Nodes, stride: usize) -> Self {
        let samples = nodes.shares.iter().step_by(stride).enumerate();
        let all = samples.flat_map(|(i, shares)| shares.iter().map(move |&share| (i, share)));
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
        Self { starts, list }
    }

    pub fn of(&self, node: usize) -> &[(u32, f32)] {
        &self.list[self.starts[node] as usize..self.starts[node + 1] as usize]
    }
}
