//! A block's values together with those of the nodes around it.

use crate::grid::{BLOCK, BLOCK_NODES, SparseGrid};

/// Nodes along the edge of a [`Neighbourhood`]: one below the block, two above.
pub(super) const SIDE: usize = BLOCK + 3;

/// Values of a block's nodes, of the layer below and of the two layers above it; x fastest.
pub(super) struct Neighbourhood(pub(super) [f32; SIDE * SIDE * SIDE]);

impl Neighbourhood {
    pub(super) fn new() -> Self {
        Self([0.0; SIDE * SIDE * SIDE])
    }

    /// Index of the block's node (x, y, z), each from -1 to 9.
    #[inline]
    pub(super) fn index(x: i32, y: i32, z: i32) -> usize {
        let side = SIDE as i32;
        (((z + 1) * side + y + 1) * side + x + 1) as usize
    }

    /// Loads the surroundings of a block, which need not be a stored one.
    pub(super) fn load(&mut self, grid: &SparseGrid, values: &[f32], block: [i32; 3], inside: f32, outside: f32) {
        let last = BLOCK - 1;
        // Nodes taken from the block below, from this one and from the one above: first in it, first here, count.
        let parts = [(last, 0, 1), (0, 1, BLOCK), (0, BLOCK + 1, 2)];
        for (dz, &(z0, tz, nz)) in parts.iter().enumerate() {
            for (dy, &(y0, ty, ny)) in parts.iter().enumerate() {
                for (dx, &(x0, tx, nx)) in parts.iter().enumerate() {
                    let [x, y, z] = block;
                    let slot = grid.slot(x + dx as i32 - 1, y + dy as i32 - 1, z + dz as i32 - 1);
                    for (k, j) in (0..nz).flat_map(|k| (0..ny).map(move |j| (k, j))) {
                        let to = ((tz + k) * SIDE + ty + j) * SIDE + tx;
                        let row = &mut self.0[to..to + nx];
                        if slot >= SparseGrid::INSIDE {
                            row.fill(if slot == SparseGrid::INSIDE { inside } else { outside });
                        } else {
                            let from = slot as usize * BLOCK_NODES + ((z0 + k) * BLOCK + y0 + j) * BLOCK + x0;
                            row.copy_from_slice(&values[from..from + nx]);
                        }
                    }
                }
            }
        }
    }
}
