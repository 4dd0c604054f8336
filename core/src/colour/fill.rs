//! Colours of vertices that no camera sees (§7), by diffusion from their surroundings.

use crate::{point_cloud::Mesh, surface::VertexNeighbours};
use alloc::vec::Vec;
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
    let neighbours = VertexNeighbours::of_some(mesh, |v| colours[v as usize].is_none());
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
