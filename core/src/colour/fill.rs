//! Colours of vertices that no camera sees (§7), by diffusion from their surroundings.

use crate::point_cloud::Mesh;
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Number of Gauss-Seidel iterations that smooth the diffused colours.
const RELAXATIONS: u32 = 16;
/// Colour of a mesh that no camera sees at all.
const GRAY: Vec3 = Vec3::splat(128.0);

/// Diffuses the known colours over the edges of the mesh to the vertices without a colour. Components without any known
/// colour get the mean of all known colours. `out` must be empty; it receives the colours of all vertices.
pub(super) fn fill(mesh: &Mesh, colours: &[Option<Vec3>], out: &mut Vec<Vec3>) {
    let known = || colours.iter().flatten();
    let count = known().count();
    let mean = if count > 0 { known().sum::<Vec3>() / count as f32 } else { GRAY };
    out.extend(colours.iter().map(|c| c.unwrap_or(mean)));
    if count == 0 || count == colours.len() {
        return;
    }
    let neighbours = Neighbours::new(mesh, |v| colours[v as usize].is_none());
    // The vertices without a colour, in the order in which the known colours reach them.
    let mut reached: Vec<bool> = colours.iter().map(Option::is_some).collect();
    let mut order: Vec<u32> = Vec::new();
    let mut front: Vec<u32> = (0..colours.len() as u32)
        .filter(|&v| !reached[v as usize] && neighbours.of(v).iter().any(|&n| reached[n as usize]))
        .collect();
    while !front.is_empty() {
        for &v in &front {
            let (sum, count) = neighbours
                .of(v)
                .iter()
                .filter(|&&n| reached[n as usize])
                .fold((Vec3::ZERO, 0.0), |(sum, count), &n| (sum + out[n as usize], count + 1.0));
            out[v as usize] = sum / count;
        }
        front.iter().for_each(|&v| reached[v as usize] = true);
        let mut next: Vec<u32> =
            front.iter().flat_map(|&v| neighbours.of(v)).copied().filter(|&n| !reached[n as usize]).collect();
        next.sort_unstable();
        next.dedup();
        order.append(&mut front);
        front = next;
    }
    for _ in 0..RELAXATIONS {
        for &v in &order {
            let around = neighbours.of(v);
            out[v as usize] = around.iter().map(|&n| out[n as usize]).sum::<Vec3>() / around.len() as f32;
        }
    }
}

/// The neighbours of some vertices. The other end of an edge is listed once per triangle at the edge.
struct Neighbours {
    starts: Vec<u32>,
    list: Vec<u32>,
}

impl Neighbours {
    fn new(mesh: &Mesh, wanted: impl Fn(u32) -> bool) -> Self {
        let mut starts = vec![0u32; mesh.positions.len() + 1];
        let corners =
            || mesh.triangles.iter().flat_map(|t| (0..3).map(move |k| (t[k], [t[(k + 1) % 3], t[(k + 2) % 3]])));
        for (v, _) in corners().filter(|&(v, _)| wanted(v)) {
            starts[v as usize + 1] += 2;
        }
        for v in 0..mesh.positions.len() {
            starts[v + 1] += starts[v];
        }
        let mut list = vec![0u32; starts[mesh.positions.len()] as usize];
        let mut next = starts.clone();
        for (v, others) in corners().filter(|&(v, _)| wanted(v)) {
            let at = &mut next[v as usize];
            list[*at as usize..][..2].copy_from_slice(&others);
            *at += 2;
        }
        Self { starts, list }
    }

    fn of(&self, v: u32) -> &[u32] {
        &self.list[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }
}
