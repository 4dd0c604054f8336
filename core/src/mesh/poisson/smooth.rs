//! Removes the node-to-node noise that irregular sampling leaves in χ.

use alloc::vec::Vec;

use crate::executor::Executor;
use crate::grid::{BLOCK, SparseGrid};
use crate::surface::neighbourhood::{Neighbourhood, SIDE};
use crate::workspace::Workspace;

/// Radius of the filter, in voxels.
pub(super) const REACH: f32 = 2.0;

/// Applies the filter 2 W - W² to χ, where W is the binomial filter [1 2 1] / 4 along each axis. Unlike W alone it
/// preserves quadratic functions, so that curved surfaces do not shrink. `inside` and `outside` are the values in
/// blocks that are not stored.
pub(super) fn smooth(
    grid: &SparseGrid,
    chi: &[f32],
    [inside, outside]: [f32; 2],
    workspace: &mut Workspace,
    executor: &dyn Executor,
) -> Vec<f32> {
    let mut once = workspace.filled(0.0, chi.len());
    binomial(grid, chi, [inside, outside], &mut once, executor);
    let mut twice = workspace.filled(0.0, chi.len());
    binomial(grid, &once, [inside, outside], &mut twice, executor);
    for (twice, once) in twice.iter_mut().zip(&once) {
        *twice = 2.0 * once - *twice;
    }
    workspace.recycle(once);
    twice
}

/// Number of rows along an axis that the smoothed rows of a block depend on.
const ROWS: usize = BLOCK + 2;

type Row = [f32; BLOCK];

#[inline]
fn mean(a: Row, b: Row, c: Row) -> Row {
    core::array::from_fn(|i| 0.25 * (a[i] + c[i]) + 0.5 * b[i])
}

fn binomial(grid: &SparseGrid, values: &[f32], [inside, outside]: [f32; 2], out: &mut [f32], executor: &dyn Executor) {
    grid.for_each_part(out, executor, |blocks| {
        let mut around = Neighbourhood::new();
        let mut along_x = [[[0.0; BLOCK]; ROWS]; ROWS];
        let mut along_y = [[[0.0; BLOCK]; BLOCK]; ROWS];
        for (block, out) in blocks {
            around.load(grid, values, block.map(i32::from), inside, outside);
            for (z, plane) in along_x.iter_mut().enumerate() {
                for (y, row) in plane.iter_mut().enumerate() {
                    let nodes: &[f32; ROWS] =
                        around.0[(z * SIDE + y) * SIDE..][..ROWS].try_into().expect("the slice has ROWS nodes");
                    let from = |first: usize| core::array::from_fn(|x| nodes[first + x]);
                    *row = mean(from(0), from(1), from(2));
                }
            }
            for (rows, plane) in along_y.iter_mut().zip(&along_x) {
                for (y, row) in rows.iter_mut().enumerate() {
                    *row = mean(plane[y], plane[y + 1], plane[y + 2]);
                }
            }
            for (i, row) in out.chunks_exact_mut(BLOCK).enumerate() {
                let (y, z) = (i % BLOCK, i / BLOCK);
                row.copy_from_slice(&mean(along_y[z][y], along_y[z + 1][y], along_y[z + 2][y]));
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Serial;
    use crate::grid::BLOCK_NODES;
    use glam::Vec3;

    /// Quadratic fields are preserved, and fields that alternate from node to node are removed.
    #[test]
    fn only_the_finest_detail_goes() {
        let grid = SparseGrid::new(Vec3::ZERO, 1.0, [2; 3], |_| 0);
        let node = |i: usize| {
            let (block, local) = (grid.blocks[i / BLOCK_NODES], i % BLOCK_NODES);
            let at = [local % BLOCK, local / BLOCK % BLOCK, local / BLOCK / BLOCK];
            core::array::from_fn(|k| usize::from(block[k]) * BLOCK + at[k])
        };
        let curved = |[x, y, z]: [usize; 3]| (x * x + 2 * y * z) as f32 - 3.0 * x as f32 - (z * z) as f32;
        let alternating = |[x, y, z]: [usize; 3]| if (x + y + z) % 2 == 0 { 5.0 } else { -5.0 };
        let fields: Vec<f32> = (0..8 * BLOCK_NODES).map(|i| curved(node(i)) + alternating(node(i))).collect();
        let smoothed = smooth(&grid, &fields, [0.0; 2], &mut Workspace::default(), &Serial);
        for (i, &value) in smoothed.iter().enumerate() {
            let at = node(i);
            // Only nodes that the border does not influence.
            if at.iter().all(|v| (2..14).contains(v)) {
                assert!((value - curved(at)).abs() < 1e-3, "{at:?}: {value}, not {}", curved(at));
            }
        }
    }
}
