//! Rays through the hull's grid, for the frontier points of §4.4.

use super::visual_hull::VisualHull;
use crate::{
    grid::{BLOCK, SparseGrid},
    math::{floor, max, min},
};
use glam::Vec3;

impl VisualHull {
    /// If the block at a point is entirely outside: the ray parameter from the point to the exit of the block.
    pub(crate) fn outside_block(&self, place: Vec3, direction: Vec3) -> Option<f32> {
        let edge = self.grid.voxel * BLOCK as f32;
        let q = (place - self.grid.origin) / edge;
        let cell = q.to_array().map(floor);
        let outside = self.grid.slot(cell[0], cell[1], cell[2]) == SparseGrid::OUTSIDE;
        outside.then(|| leave(q, direction / edge, cell))
    }

    /// The parameters at which a ray enters and leaves the hull's bounding box.
    pub(crate) fn span(&self, start: Vec3, direction: Vec3) -> Option<(f32, f32)> {
        clip(start, direction, self.lower, self.upper)
    }
}

/// Parameters at which a ray enters and leaves a box, in front of its start (the slab method of Kay & Kajiya, 1986).
fn clip(start: Vec3, direction: Vec3, lower: Vec3, upper: Vec3) -> Option<(f32, f32)> {
    let (mut near, mut far) = (0.0f32, f32::INFINITY);
    for axis in 0..3 {
        let (s, d) = (start[axis], direction[axis]);
        if d == 0.0 {
            if s < lower[axis] || s > upper[axis] {
                return None;
            }
            continue;
        }
        let (a, b) = ((lower[axis] - s) / d, (upper[axis] - s) / d);
        near = max(min(a, b), near);
        far = min(max(a, b), far);
    }
    (near < far).then_some((near, far))
}

/// Ray parameter at the exit of a unit cell.
fn leave(q: Vec3, direction: Vec3, cell: [i32; 3]) -> f32 {
    let mut t = f32::INFINITY;
    for axis in 0..3 {
        let d = direction[axis];
        if d != 0.0 {
            let wall = if d > 0.0 { cell[axis] as f32 + 1.0 } else { cell[axis] as f32 };
            t = min(max((wall - q[axis]) / d, 0.0), t);
        }
    }
    t
}
