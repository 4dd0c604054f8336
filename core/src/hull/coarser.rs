//! The hull's surface at a lower resolution, for searches of smaller pictures.

use super::visual_hull::VisualHull;
use crate::{
    executor::Executor,
    grid::{BLOCK, BLOCK_NODES, SparseGrid},
    point_cloud::Mesh,
    surface::{Unstored, marching_cubes},
    workspace::Workspace,
};

impl VisualHull {
    /// The hull's surface as a closed mesh, made of every 2^`halvings`-th node along each axis. Parts that are thinner than two
    /// such distances may be lost.
    pub fn coarser_mesh(&self, halvings: u32, workspace: &mut Workspace, executor: &dyn Executor) -> Mesh {
        let step = 1u32 << halvings;
        let voxel = self.grid.voxel * step as f32;
        // Blocks beyond the grid are outside.
        let dims = self.grid.dims.map(|n| n.div_ceil(step));
        let grid = SparseGrid::new(self.grid.origin, voxel, dims, |block| {
            let slot = |i: u32| {
                let within = [i % step, i / step % step, i / step / step];
                let [x, y, z] = [0, 1, 2].map(|k| (block[k] * step + within[k]) as i32);
                self.grid.slot(x, y, z)
            };
            let first = slot(0);
            if first >= SparseGrid::INSIDE && (1..step * step * step).all(|i| slot(i) == first) { first } else { 0 }
        });
        let mut values = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
        grid.for_each_part(&mut values, executor, |blocks| {
            for (block, values) in blocks {
                for (local, value) in values.iter_mut().enumerate() {
                    let at = [local % BLOCK, local / BLOCK % BLOCK, local / BLOCK / BLOCK];
                    let [x, y, z] = [0, 1, 2].map(|k| (usize::from(block[k]) * BLOCK + at[k]) as i32 * step as i32);
                    *value = self.grid.value(&self.values, x, y, z, -self.grid.voxel, self.grid.voxel);
                }
            }
        });
        let unstored = Unstored { inside: self.grid.voxel, outside: -self.grid.voxel };
        let mesh = marching_cubes(&grid, &values, 0.0, unstored, workspace, executor);
        workspace.recycle(values);
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        executor::Serial,
        hull::HullParams,
        progress::Silent,
        testing::{pinhole, ring, silhouette_of},
        view::View,
    };
    use alloc::vec::Vec;
    use glam::Vec3;

    const RADIUS: f32 = 0.5;

    fn hull() -> VisualHull {
        let views: Vec<View> = ring(12, 4.0, 0.4)
            .enumerate()
            .map(|(i, from)| silhouette_of(&[(Vec3::ZERO, RADIUS)], &pinhole(from, Vec3::ZERO, 240, 520.0), i as u16))
            .collect();
        VisualHull::new(&views, &HullParams { voxel_pixels: 1.5 }, &Silent).expect("a ball")
    }

    #[test]
    fn every_node_gives_the_mesh_itself() {
        let (hull, workspace) = (hull(), &mut Workspace::default());
        let [own, every] = [hull.mesh(workspace, &Serial), hull.coarser_mesh(0, workspace, &Serial)];
        assert_eq!((own.positions, own.triangles), (every.positions, every.triangles));
    }

    /// Each halving leaves a quarter of the triangles, and vertices stay within half a voxel of the surface.
    #[test]
    fn coarser_meshes_follow_the_surface() {
        let (hull, workspace) = (hull(), &mut Workspace::default());
        let own = hull.mesh(workspace, &Serial).triangles.len();
        for halvings in 1..4 {
            let mesh = hull.coarser_mesh(halvings, workspace, &Serial);
            let share = mesh.triangles.len() as f32 * (1 << (2 * halvings)) as f32 / own as f32;
            assert!((0.8..1.2).contains(&share), "{share} of the expected triangles");
            let voxel = hull.field().0.voxel * (1 << halvings) as f32;
            let farthest = mesh.positions.iter().map(|&p| hull.signed_distance(p).abs()).fold(0.0, f32::max);
            assert!(farthest < 0.5 * voxel, "{farthest} from the hull, with voxels of {voxel}");
        }
    }
}
