//! Spreads the vertices evenly over the surface.
//!
//! Marching cubes places vertices where the surface meets the grid's edges: some lie next to each other, and elsewhere gaps
//! are wide. Colours are sampled at vertices, so that gaps lose detail of the pictures. They also lie elsewhere on the
//! subject in every frame, which makes its colours flicker. Here each vertex moves halfway to the mean of its neighbours, but
//! only along the surface, so that the shape stays.

use glam::Vec3;

use super::surface::smooth_normals;
use crate::executor::Executor;
use crate::point_cloud::Mesh;
use crate::surface::{VertexNeighbours, complete_normals};
use crate::workspace::Workspace;

/// Vertices that one job of an executor works on.
const VERTICES_PER_JOB: usize = 1 << 12;

/// Moves the vertices of a mesh along its surface, so many times, and renews their normals.
pub(in crate::mesh) fn even(mesh: &mut Mesh, passes: u32, workspace: &mut Workspace, executor: &dyn Executor) {
    if passes == 0 {
        return;
    }
    let neighbours = VertexNeighbours::new(mesh);
    let mut moved = workspace.filled(Vec3::ZERO, mesh.positions.len());
    for _ in 0..passes {
        let (positions, normals) = (&mesh.positions, &mesh.normals);
        executor.map_parts(moved.chunks_mut(VERTICES_PER_JOB), |part, moved| {
            for (v, moved) in (part * VERTICES_PER_JOB..).zip(moved) {
                // Each neighbour is listed twice, because two triangles meet at each edge.
                let around = neighbours.of(v as u32);
                let mean = |of: &[Vec3]| {
                    around.iter().fold(Vec3::ZERO, |sum, &other| sum + of[other as usize]) / around.len() as f32
                };
                let (way, normal) = ((mean(positions) - positions[v]) * 0.5, normals[v]);
                let along = way - normal * way.dot(normal);
                // The surface bends away from its tangent by half of the way times the change of the normal. The normal changes
                // by half of its difference to the neighbours' mean, because the way is half of that to their mean.
                *moved = positions[v] + along - normal * (0.25 * along.dot(mean(normals)));
            }
        });
        core::mem::swap(&mut mesh.positions, &mut moved);
        mesh.normals.fill(Vec3::ZERO);
        complete_normals(mesh);
        smooth_normals(mesh, workspace);
    }
    workspace.recycle(moved);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Serial;
    use crate::grid::{BLOCK_NODES, SparseGrid};
    use crate::math::{max, min, sqrt};
    use crate::surface::{Unstored, marching_cubes};
    use alloc::vec::Vec;

    /// Radius of a ball in voxels.
    const RADIUS: f32 = 9.0;
    const MIDDLE: Vec3 = Vec3::splat(15.6);

    /// A ball on a grid with voxels of length 1.
    fn ball() -> Mesh {
        let grid = SparseGrid::new(Vec3::ZERO, 1.0, [4; 3], |_| 0);
        let distances: Vec<f32> = (0..grid.blocks.len() * BLOCK_NODES)
            .map(|i| {
                let (block, local) = (grid.blocks[i / BLOCK_NODES], i % BLOCK_NODES);
                let at = [local % 8, local / 8 % 8, local / 64];
                let [x, y, z] = core::array::from_fn(|k| (usize::from(block[k]) * 8 + at[k]) as f32);
                RADIUS - (grid.node(0, 0, 0) + Vec3::new(x, y, z) - MIDDLE).length()
            })
            .collect();
        let unstored = Unstored { inside: 1.0, outside: -1.0 };
        marching_cubes(&grid, &distances, 0.0, unstored, &mut Workspace::default(), &Serial)
    }

    /// The shortest edge, the longest edge, and the largest distance of a vertex from the ball.
    fn measures(mesh: &Mesh) -> [f32; 3] {
        let edges = mesh.triangles.iter().flat_map(|t| (0..3).map(move |k| [t[k], t[(k + 1) % 3]]));
        let square = |[a, b]: [u32; 2]| mesh.positions[a as usize].distance_squared(mesh.positions[b as usize]);
        let (least, most) = edges.map(square).fold((f32::INFINITY, 0.0), |(a, b), s| (min(a, s), max(b, s)));
        let off = mesh.positions.iter().map(|&p| (p.distance(MIDDLE) - RADIUS).abs()).fold(0.0, max);
        [sqrt(least), sqrt(most), off]
    }

    #[test]
    fn vertices_are_spread_and_stay_on_the_surface() {
        let before = ball();
        let mut after = before.clone();
        even(&mut after, 2, &mut Workspace::default(), &Serial);
        let ([short, long, off], [least, most, away]) = (measures(&before), measures(&after));
        assert!(short < 0.1 && least > 0.35, "shortest edge {short}, then {least}");
        assert!(most <= long, "longest edge {long}, then {most}");
        // Along tangents alone, vertices would leave the ball by 0.02 voxels.
        assert!(away < off + 0.006, "distance from the ball {off}, then {away}");
        assert!(after.triangles == before.triangles);
        for (p, n) in after.positions.iter().zip(&after.normals) {
            assert!(n.dot((*p - MIDDLE).normalize()) > 0.995 && (n.length() - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn without_passes_nothing_changes() {
        let before = ball();
        let mut after = before.clone();
        even(&mut after, 0, &mut Workspace::default(), &Serial);
        assert_eq!(after.hash(), before.hash());
    }
}
