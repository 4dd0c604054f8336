//! Conjugate gradients on one level with the Jacobi preconditioner (Hestenes & Stiefel, 1952).

use super::cells::Cells;
use super::spline::ABSENT;
use crate::error::Result;
use crate::executor::Executor;
use crate::grid::{BLOCK, BLOCK_NODES, BLOCKS_PER_JOB};
use crate::workspace::Workspace;

/// Nodes that one job of an executor works on.
const NODES: usize = BLOCKS_PER_JOB * BLOCK_NODES;

/// The operator A: six times the node minus its neighbours (the negative Laplacian), plus the screening of the cells.
pub(super) struct Operator<'a> {
    pub(super) neighbours: &'a [[u32; 6]],
    pub(super) cells: &'a Cells,
    pub(super) screening: f32,
    /// Reciprocal of the diagonal; 0 at nodes whose value is fixed.
    pub(super) inverse_diagonal: &'a [f32],
}

type Row = [f32; BLOCK];
const NOTHING: [f32; BLOCK_NODES] = [0.0; BLOCK_NODES];

#[inline]
fn row(block: &[f32], z: usize, y: usize) -> &Row {
    let first = (z * BLOCK + y) * BLOCK;
    block[first..first + BLOCK].try_into().expect("a row has BLOCK nodes")
}

impl Operator<'_> {
    /// Computes `out` = A `v` and returns v · A v. `v` must be 0 at fixed nodes for the product to be right.
    fn apply(&self, v: &[f32], out: &mut [f32], executor: &dyn Executor) -> f64 {
        let parts = out.chunks_mut(NODES);
        let products = executor.map_parts(parts, |i, part| self.apply_to_part(v, i * BLOCKS_PER_JOB, part));
        products.into_iter().sum()
    }

    /// [`Self::apply`] for the blocks from `first` on, for as many as `out` has.
    fn apply_to_part(&self, v: &[f32], first: usize, out: &mut [f32]) -> f64 {
        let mut product = 0.0;
        let block = |slot: u32| -> &[f32] {
            if slot == ABSENT { &NOTHING } else { &v[slot as usize * BLOCK_NODES..][..BLOCK_NODES] }
        };
        for (slot, out) in (first..).zip(out.chunks_exact_mut(BLOCK_NODES)) {
            let own = block(slot as u32);
            let [left, right, front, back, below, above] = self.neighbours[slot].map(block);
            let mut lanes = [0.0; BLOCK];
            for z in 0..BLOCK {
                for y in 0..BLOCK {
                    let centre = row(own, z, y);
                    let y0 = if y > 0 { row(own, z, y - 1) } else { row(front, z, BLOCK - 1) };
                    let y1 = if y < BLOCK - 1 { row(own, z, y + 1) } else { row(back, z, 0) };
                    let z0 = if z > 0 { row(own, z - 1, y) } else { row(below, BLOCK - 1, y) };
                    let z1 = if z < BLOCK - 1 { row(own, z + 1, y) } else { row(above, 0, y) };
                    let [a, b, c, d, e, f, g, h] = *centre;
                    let x0 = [row(left, z, y)[BLOCK - 1], a, b, c, d, e, f, g];
                    let x1 = [b, c, d, e, f, g, h, row(right, z, y)[0]];
                    let first = (z * BLOCK + y) * BLOCK;
                    let out = &mut out[first..first + BLOCK];
                    for x in 0..BLOCK {
                        let sum = ((x0[x] + x1[x]) + (y0[x] + y1[x])) + (z0[x] + z1[x]);
                        out[x] = 6.0 * centre[x] - sum;
                        lanes[x] += centre[x] * out[x];
                    }
                }
            }
            product += sum_lanes(lanes);
            if self.screening > 0.0 {
                for cell in self.cells.of_block(slot) {
                    let force = self.screening * cell.area * cell.value(v);
                    for (local, share) in cell.corners_in(slot) {
                        out[local] += force * share;
                        product += f64::from(force * share * own[local]);
                    }
                }
            }
        }
        product
    }

    /// Improves the solution `x` of A x = `rhs`, until the residual is `tolerance` times the right-hand side or less,
    /// and for at most `iterations`. `rhs` is overwritten. `step` is called once per iteration.
    pub(super) fn solve(
        &self,
        rhs: &mut [f32],
        x: &mut [f32],
        iterations: u32,
        tolerance: f64,
        workspace: &mut Workspace,
        executor: &dyn Executor,
        mut step: impl FnMut() -> Result<()>,
    ) -> Result<()> {
        let weights = self.inverse_diagonal;
        let target = norm(rhs, weights) * tolerance * tolerance;
        let mut image = workspace.filled(0.0, x.len());
        self.apply(x, &mut image, executor);
        let residual = rhs;
        for (r, a) in residual.iter_mut().zip(&image) {
            *r -= a;
        }
        let mut direction = workspace.empty(x.len());
        direction.extend(residual.iter().zip(weights).map(|(r, d)| r * d));
        let mut size = norm(residual, weights);
        for _ in 0..iterations {
            step()?;
            if size <= target {
                break;
            }
            let curvature = self.apply(&direction, &mut image, executor);
            let alpha = (size / curvature) as f32;
            let previous = size;
            let parts = x.chunks_mut(NODES).zip(residual.chunks_mut(NODES)).zip(direction.chunks(NODES));
            let sizes = executor.map_parts(parts, |part, ((x, r), p)| {
                let (a, d) = (&image[part * NODES..], &weights[part * NODES..]);
                for i in 0..x.len() {
                    x[i] += alpha * p[i];
                    r[i] -= alpha * a[i];
                }
                norm(r, d)
            });
            size = sizes.into_iter().sum();
            let beta = (size / previous) as f32;
            executor.map_parts(direction.chunks_mut(NODES).zip(residual.chunks(NODES)), |part, (p, r)| {
                for ((p, r), d) in p.iter_mut().zip(r).zip(&weights[part * NODES..]) {
                    *p = r * d + beta * *p;
                }
            });
        }
        workspace.recycle(image);
        workspace.recycle(direction);
        Ok(())
    }
}

fn sum_lanes(lanes: [f32; BLOCK]) -> f64 {
    lanes.iter().fold(0.0, |sum, &lane| sum + f64::from(lane))
}

/// Σ r² d, summed in the order of the nodes.
fn norm(r: &[f32], d: &[f32]) -> f64 {
    let mut sum = 0.0;
    for (r, d) in r.chunks_exact(BLOCK_NODES).zip(d.chunks_exact(BLOCK_NODES)) {
        let mut lanes = [0.0; BLOCK];
        for i in 0..BLOCK_NODES {
            lanes[i % BLOCK] += r[i] * r[i] * d[i];
        }
        sum += sum_lanes(lanes);
    }
    sum
}
