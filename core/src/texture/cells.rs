//! Which texels a triangle covers, in integer arithmetic: two triangles with a common edge never cover the same texel.

use glam::Vec2;

/// Fixed-point positions have this many units per texel.
const UNITS: i64 = 256;

/// A triangle in a texture. The centre of the first texel is at (0, 0).
pub(super) struct Cells {
    corners: [[i64; 2]; 3],
    /// Twice the area, in units².
    area: i64,
}

/// A texel that a triangle covers.
pub(super) struct Cell {
    pub x: i32,
    pub y: i32,
    /// Weights of the corners, which add up to one.
    pub weights: [f32; 3],
}

impl Cells {
    /// `corners` are positions in texels, either way round. `None` for a triangle without area.
    pub(super) fn new(corners: [Vec2; 3]) -> Option<Self> {
        let fixed = |v: f32| libm::roundf(v * UNITS as f32) as i64;
        let corners = corners.map(|p| [fixed(p.x), fixed(p.y)]);
        let area = edge(corners[0], corners[1], corners[2]);
        (area != 0).then_some(Self { corners, area })
    }

    /// Calls `f` for each texel whose centre the triangle covers. A centre on an edge belongs to the triangle on one side
    /// of it only.
    pub(super) fn for_each(&self, mut f: impl FnMut(Cell)) {
        let [a, b, c] = self.corners;
        let sign = self.area.signum();
        let range = |axis: usize| {
            let (low, high) = (a[axis].min(b[axis]).min(c[axis]), a[axis].max(b[axis]).max(c[axis]));
            (low + UNITS - 1).div_euclid(UNITS)..=high.div_euclid(UNITS)
        };
        let edges = [(b, c), (c, a), (a, b)];
        // A centre on an edge counts as inside if the edge runs downwards, or to the right where it is level. The same edge
        // runs the other way in the other triangle.
        let own = edges.map(|(p, q)| {
            let along = [(q[0] - p[0]) * sign, (q[1] - p[1]) * sign];
            along[1] > 0 || (along[1] == 0 && along[0] > 0)
        });
        for y in range(1) {
            for x in range(0) {
                let centre = [x * UNITS, y * UNITS];
                let values = edges.map(|(p, q)| edge(p, q, centre) * sign);
                if (0..3).all(|k| values[k] > 0 || (values[k] == 0 && own[k])) {
                    let weights = values.map(|v| v as f32 / (self.area * sign) as f32);
                    f(Cell { x: x as i32, y: y as i32, weights });
                }
            }
        }
    }
}

/// Twice the area of a triangle, in units². It is positive if its corners turn from x to y.
fn edge(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}
