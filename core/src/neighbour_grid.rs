//! Radius queries over points, by a uniform grid in which the points are sorted by cell.

use alloc::vec::Vec;
use glam::Vec3;

/// Points sorted into cubic cells, whose edge is the query radius or larger.
pub struct NeighbourGrid {
    cell: f32,
    lower: Vec3,
    size: [i32; 3],
    /// Indices of the points, cell after cell (x fastest), and in ascending order within a cell.
    order: Vec<u32>,
    /// Start of each cell in `order`; then the number of points.
    starts: Vec<u32>,
}

/// Cells are enlarged until there are at most about this many per point.
const MAX_CELLS_PER_POINT: usize = 32;

impl NeighbourGrid {
    /// Sorts points for queries within `radius`.
    pub fn new(points: impl ExactSizeIterator<Item = Vec3> + Clone, radius: f32) -> Self {
        let count = points.len();
        let (mut lower, mut upper) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for p in points.clone() {
            (lower, upper) = (lower.min(p), upper.max(p));
        }
        if count == 0 {
            (lower, upper) = (Vec3::ZERO, Vec3::ZERO);
        }
        let mut cell = radius;
        let cells = |cell: f32| [0, 1, 2].map(|a| ((upper[a] - lower[a]) / cell) as i32 + 1);
        let volume = |s: [i32; 3]| s.iter().map(|&v| f64::from(v)).product::<f64>();
        while volume(cells(cell)) > (count * MAX_CELLS_PER_POINT + 4096) as f64 {
            cell *= 1.5;
        }
        let size = cells(cell);
        let mut grid = Self { cell, lower, size, order: Vec::new(), starts: Vec::new() };
        // Counting sort is stable: within a cell the points remain in the order of their indices.
        grid.starts.resize((size[0] * size[1] * size[2]) as usize + 1, 0);
        for p in points.clone() {
            let cell = grid.cell_of(p);
            grid.starts[cell + 1] += 1;
        }
        for c in 1..grid.starts.len() {
            grid.starts[c] += grid.starts[c - 1];
        }
        let mut next = grid.starts.clone();
        grid.order.resize(count, 0);
        for (i, p) in points.enumerate() {
            let slot = &mut next[grid.cell_of(p)];
            grid.order[*slot as usize] = i as u32;
            *slot += 1;
        }
        grid
    }

    /// Calls `f` with the index of every point in the cells that a ball touches. These are all points in the ball, and
    /// some outside.
    #[inline]
    pub fn near(&self, p: Vec3, radius: f32, mut f: impl FnMut(usize)) {
        let low = self.coordinates(p - Vec3::splat(radius));
        let high = self.coordinates(p + Vec3::splat(radius));
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                let row = (z * self.size[1] + y) * self.size[0];
                let (from, to) = ((row + low[0]) as usize, (row + high[0]) as usize);
                for &i in &self.order[self.starts[from] as usize..self.starts[to + 1] as usize] {
                    f(i as usize);
                }
            }
        }
    }

    fn coordinates(&self, p: Vec3) -> [i32; 3] {
        [0, 1, 2].map(|a| (((p[a] - self.lower[a]) / self.cell) as i32).clamp(0, self.size[a] - 1))
    }

    fn cell_of(&self, p: Vec3) -> usize {
        let [x, y, z] = self.coordinates(p);
        ((z * self.size[1] + y) * self.size[0] + x) as usize
    }
}

#[cfg(test)]
mod tests;
