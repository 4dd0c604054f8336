//! Where a ray runs inside the hull (§4.1: the depth range of the search).

use super::{BLOCK, SparseGrid, VisualHull};
use crate::math::{floor, max, min};
use alloc::vec::Vec;
use glam::Vec3;

/// A piece of a ray inside the hull, in the ray's parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Where the ray enters.
    pub near: f32,
    /// Where it leaves.
    pub far: f32,
}

/// Signed distance may grow faster than the path by this factor (perspective and oblique rays).
const STEEPNESS: f32 = 1.4;

impl VisualHull<'_> {
    /// The pieces of the ray `start + t * direction`, t > 0, inside the hull, in order; `out` is cleared first.
    ///
    /// The ends are roots of [`Self::signed_distance`]; pieces shorter than half a grid cell can be missed.
    pub fn intervals(&self, start: Vec3, direction: Vec3, out: &mut Vec<Interval>) {
        out.clear();
        let Some((mut t, end)) = clip(start, direction, self.lower, self.upper) else { return };
        // Parameter per scene unit.
        let unit = 1.0 / direction.length();
        let shortest = 0.5 * self.grid.voxel * unit;
        let edge = self.grid.voxel * BLOCK as f32;
        let (mut inside, mut previous) = (false, t);
        let mut near = t;
        while t < end {
            let p = start + direction * t;
            let q = (p - self.grid.origin) / edge;
            let cell = [floor(q.x), floor(q.y), floor(q.z)];
            let slot = self.grid.slot(cell[0], cell[1], cell[2]);
            let (now, step) = if slot >= SparseGrid::INSIDE {
                (slot == SparseGrid::INSIDE, leave(q, direction / edge, cell) + 1e-3 * shortest)
            } else {
                let d = self.coarse(p);
                (d > 0.0, max(d.abs() * unit / STEEPNESS, shortest))
            };
            if now != inside {
                let root = self.root(start, direction, previous, t, inside);
                if now {
                    near = root;
                } else {
                    out.push(Interval { near, far: root });
                }
                inside = now;
            }
            previous = t;
            t += step;
        }
        if inside {
            out.push(Interval { near, far: end });
        }
    }

    /// If the grid's block at a place is all outside: the parameter along a ray from there to its end.
    pub(crate) fn outside_block(&self, place: Vec3, direction: Vec3) -> Option<f32> {
        let edge = self.grid.voxel * BLOCK as f32;
        let q = (place - self.grid.origin) / edge;
        let cell = q.to_array().map(floor);
        let outside = self.grid.slot(cell[0], cell[1], cell[2]) == SparseGrid::OUTSIDE;
        outside.then(|| leave(q, direction / edge, cell))
    }

    /// Where a ray runs through the hull's bounding box.
    pub(crate) fn span(&self, start: Vec3, direction: Vec3) -> Option<(f32, f32)> {
        clip(start, direction, self.lower, self.upper)
    }

    /// Root of the exact signed distance between two parameters, by bisection safeguarded false position.
    fn root(&self, start: Vec3, direction: Vec3, mut a: f32, mut b: f32, a_inside: bool) -> f32 {
        let value = |t: f32| self.signed_distance(start + direction * t);
        let (mut va, mut vb) = (value(a), value(b));
        if (va > 0.0) != a_inside || (vb > 0.0) == a_inside {
            // The grid saw a crossing that the exact function has a little beyond: the nearer end is the answer.
            return if va.abs() < vb.abs() { a } else { b };
        }
        for _ in 0..3 {
            let t = (a + (b - a) * (va / (va - vb)).clamp(0.05, 0.95)).clamp(a, b);
            let v = value(t);
            if (v > 0.0) == a_inside {
                (a, va) = (t, v);
            } else {
                (b, vb) = (t, v);
            }
        }
        a + (b - a) * (va / (va - vb))
    }
}

/// Parameters at which a ray enters and leaves a box, in front of its start.
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

/// Parameter to the exit of a unit cell.
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
