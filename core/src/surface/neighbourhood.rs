//! The values of a block together with those of the nodes around it.

use glam::Vec3;

use super::bspline::{derivatives, quadratic};
use crate::{
    grid::{BLOCK, BLOCK_NODES, SparseGrid},
    math::floor,
};

/// Nodes along an edge of a [`Neighbourhood`]: the block's nodes, one below and two above.
pub(crate) const SIDE: usize = BLOCK + 3;

/// Values of a block's nodes, of one layer of nodes below it and of two layers above it; x fastest.
pub(crate) struct Neighbourhood(pub(crate) [f32; SIDE * SIDE * SIDE]);

impl Neighbourhood {
    pub(crate) fn new() -> Self {
        Self([0.0; SIDE * SIDE * SIDE])
    }

    /// Index of the block's node (x, y, z), each from -1 to 9.
    #[inline]
    pub(crate) fn index(x: i32, y: i32, z: i32) -> usize {
        let side = SIDE as i32;
        (((z + 1) * side + y + 1) * side + x + 1) as usize
    }

    /// Loads the values of a block and its surroundings. The block need not be stored.
    pub(crate) fn load(&mut self, grid: &SparseGrid, values: &[f32], block: [i32; 3], inside: f32, outside: f32) {
        let last = BLOCK - 1;
        // Along each axis nodes come from the block below, this block and the block above. For each: first node there,
        // first node here, number of nodes.
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
                            let from = &values[from..from + nx];
                            // For lengths that the compiler knows no function is called.
                            match nx {
                                1 => copy::<1>(from, row),
                                2 => copy::<2>(from, row),
                                _ => copy::<BLOCK>(from, row),
                            }
                        }
                    }
                }
            }
        }
    }

    /// Gradient of the values, smoothed by the quadratic B-spline, at a point relative to the block's first node. It is
    /// evaluated at the point itself because the gradient of a steep profile changes its direction between nodes.
    pub(crate) fn gradient(&self, at: Vec3) -> Vec3 {
        let (wx, dx, x) = spline(at.x);
        let (wy, dy, y) = spline(at.y);
        let (wz, dz, z) = spline(at.z);
        let mut gradient = Vec3::ZERO;
        for k in 0..3 {
            for j in 0..3 {
                let first = Self::index(x - 1, y + j as i32 - 1, z + k as i32 - 1);
                let [a, b, c] = [self.0[first], self.0[first + 1], self.0[first + 2]];
                let value = wx[0] * a + wx[1] * b + wx[2] * c;
                gradient.x += (dx[0] * a + dx[1] * b + dx[2] * c) * wy[j] * wz[k];
                gradient.y += value * dy[j] * wz[k];
                gradient.z += value * wy[j] * dz[k];
            }
        }
        gradient
    }
}

/// Copies N values.
#[inline(always)]
fn copy<const N: usize>(from: &[f32], to: &mut [f32]) {
    to[..N].copy_from_slice(&from[..N]);
}

/// Values and derivatives of the quadratic B-spline at the three nodes nearest to a coordinate, and the middle node.
fn spline(at: f32) -> ([f32; 3], [f32; 3], i32) {
    let nearest = floor(at + 0.5);
    let d = at - nearest as f32;
    (quadratic(d), derivatives(d), nearest)
}
