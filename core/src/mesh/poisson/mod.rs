//! Poisson surface reconstruction (§6.1; Kazhdan, Bolitho & Hoppe, SGP 2006) on a hierarchy of sparse grids, with the
//! screening term of Kazhdan & Hoppe (Screened Poisson Surface Reconstruction, 2013) and the envelope constraint of
//! Kazhdan, Chuang, Rusinkiewicz & Hoppe (SGP 2020).
//!
//! χ is the indicator function of the object, smoothed by the quadratic B-spline. Its gradient equals the field of the
//! points' inward normals, smoothed by the same spline. The levels are solved from coarse to fine. Each is solved on
//! the blocks that the surface can pass; the coarser solution is the initial value and the boundary value. On the
//! finest level χ is converted to the distance to the surface.

mod calm;
mod cells;
mod denoise;
mod domain;
mod even;
mod level;
mod patch;
mod profile;
mod samples;
mod smooth;
mod solution;
mod solve;
mod spline;
mod surface;
mod system;

use alloc::{borrow::Cow, vec, vec::Vec};
use glam::Vec3;

use super::steps::Steps;
use crate::error::{Error, Result};
use crate::executor::Executor;
use crate::grid::{BLOCK_NODES, SparseGrid};
use crate::math::max;
use crate::point_cloud::Point;
use crate::surface::Envelope;
use crate::workspace::Workspace;
use cells::Cells;
pub(super) use domain::blocks;
pub(super) use even::even;
use level::GridLevel;
use patch::SAMPLES_PER_STEP;
use samples::Sample;
use solution::{MARGIN, Solution};
use solve::Operator;
pub(super) use surface::smooth_normals;

/// Iterations on each level except the coarsest. Few are sufficient, because the coarser solution is a good initial
/// value.
const ITERATIONS: u32 = 6;
/// Largest number of iterations on the coarsest level, and the residual at which they stop, relative to the right-hand
/// side.
const ITERATIONS_COARSEST: u32 = 200;
const TOLERANCE: f64 = 1e-4;

/// Largest number of steps that [`solve`] reports for so many points.
pub(super) fn steps(low: Vec3, high: Vec3, voxel: f32, points: usize) -> u32 {
    let (_, levels) = domain::domain(low, high, voxel);
    let (levels, parts) = (levels as u32, points.div_ceil(SAMPLES_PER_STEP) as u32);
    // Collecting has 3, and converting to distances 2. Samples are weighed on each level but the finest. The coarsest
    // level reports no iterations.
    5 + (levels - 1) * (3 + parts) + levels * (5 + parts) + (levels - 1) * ITERATIONS
}

/// How closely the surface follows the points.
#[derive(Clone, Copy)]
pub(super) struct Pull {
    /// Weight of the term that pulls the surface to the points.
    pub(super) screening: f32,
    /// Standard deviation of points, in their own unit, at which half of the finest detail is kept ([`calm`]). Without
    /// it all is kept.
    pub(super) calm: Option<f32>,
}

/// Solves for χ over the bounds `low`, `high`. If there is an envelope, χ is held at 0 outside it. Points that are owned are
/// freed as soon as their samples are made.
pub(super) fn solve(
    points: Cow<[Point]>,
    (low, high): (Vec3, Vec3),
    voxel: f32,
    Pull { screening, calm }: Pull,
    envelope: Option<&dyn Envelope>,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    steps: &mut Steps,
) -> Result<Solution> {
    let (finest, count) = domain::domain(low, high, voxel);
    let mut samples = samples::collect(points, &finest, workspace, executor, || steps.step())?;
    if samples.is_empty() {
        return Err(Error::NoSurface);
    }
    samples::weigh(&mut samples, &finest, count, workspace, executor, || steps.step())?;
    // Samples whose detail is finer than a level act on that level as a whole, so that they can be merged.
    let mut samples = vec![samples];
    for level in 1..count {
        let settled = |sample: &Sample| sample.detail <= (level - 1) as f32;
        samples.push(samples::coarser(&samples[level - 1], settled, workspace));
    }

    let mut levels: Vec<GridLevel> = Vec::with_capacity(count);
    let mut sparse: Vec<f32> = Vec::new();
    let (mut iso, mut cells, mut held) = (0.5, Cells::default(), None);
    for level in (0..count).rev() {
        let samples = samples.pop().expect("there is one list per level");
        let mut next = if levels.is_empty() {
            GridLevel::coarsest(&finest, level, workspace)
        } else {
            GridLevel::refine(&levels, &samples, level, iso, workspace, executor)
        };
        steps.step()?;
        let next_level = NextLevel { samples: &samples, grid: &next.grid, level };
        let mut rhs = right_hand_side(&levels, &mut sparse, next_level, workspace, executor, || steps.step())?;
        steps.step()?;
        cells.recycle_into(workspace);
        cells = Cells::new(&samples, &next.grid, level, workspace, executor);
        workspace.recycle(samples);
        steps.step()?;
        held.into_iter().for_each(|above| workspace.recycle(above));
        held = envelope.map(|envelope| domain::distances(&next.grid, envelope, MARGIN, workspace, executor));
        let outside = |node: usize| held.as_ref().is_some_and(|held: &Vec<f32>| held[node] < -MARGIN);
        for (node, chi) in next.chi.iter_mut().enumerate() {
            if outside(node) {
                *chi = 0.0;
            }
        }
        steps.step()?;
        let neighbours = system::neighbours(&next.grid);
        let inverse_diagonal = system::inverse_diagonal(&neighbours, &cells, screening, outside, workspace, executor);
        cells.scatter(&mut rhs, executor, |value, cell, share| {
            *value += cell.chi * screening * cell.area * share;
        });
        steps.step()?;
        let operator =
            Operator { neighbours: &neighbours, cells: &cells, screening, inverse_diagonal: &inverse_diagonal };
        if levels.is_empty() {
            operator.solve(&mut rhs, &mut next.chi, ITERATIONS_COARSEST, TOLERANCE, workspace, executor, || Ok(()))?;
        } else {
            operator.solve(&mut rhs, &mut next.chi, ITERATIONS, TOLERANCE, workspace, executor, || steps.step())?;
        }
        iso = cells.median(&next.chi, workspace).unwrap_or(iso);
        levels.push(next);
        workspace.recycle(rhs);
        workspace.recycle(inverse_diagonal);
    }
    let finest = levels.pop().expect("there is at least one level");
    workspace.recycle(sparse);
    levels.into_iter().for_each(|level| workspace.recycle(level.chi));
    steps.step()?;
    let mut distances = surface::distances(&finest, iso, held.as_ref(), workspace, executor);
    steps.step()?;
    let at_points = cells.median(&distances, workspace).unwrap_or(0.0);
    distances.iter_mut().for_each(|distance| *distance -= at_points);
    let calm = calm.map(|half| (calm::variances(&cells, distances.len(), workspace, executor), half));
    cells.recycle_into(workspace);
    workspace.recycle(finest.chi);
    Ok(Solution { grid: finest.grid, distances, calm, envelope: held })
}

/// The level to solve.
#[derive(Clone, Copy)]
struct NextLevel<'a> {
    samples: &'a [Sample],
    grid: &'a SparseGrid,
    level: usize,
}

/// The right-hand side of a level. Samples of this level's detail or finer are splatted here. Coarser samples act
/// through `sparse`, which is their part of the right-hand side on the next coarser level and is interpolated to this
/// one. `step` is called before each part of the samples.
fn right_hand_side(
    levels: &[GridLevel],
    sparse: &mut Vec<f32>,
    NextLevel { samples, grid, level }: NextLevel,
    workspace: &mut Workspace,
    executor: &dyn Executor,
    step: impl FnMut() -> Result<()>,
) -> Result<Vec<f32>> {
    let here = level as f32;
    let mut rhs = workspace.filled(0.0, grid.blocks.len() * BLOCK_NODES);
    if let Some(above) = levels.last() {
        // Measured in voxels of this level, the same divergence is a quarter as large.
        let part = |[x, y, z]: [i32; 3]| above.grid.value(sparse, x, y, z, 0.0, 0.0);
        level::prolong(part, grid, 0.25, &mut rhs, executor);
    }
    // Finer samples act in full. The share of a sample that belongs to a level decreases linearly to 0 at one level
    // from its own.
    let whole = |detail: f32| (1.0 - (detail - here)).clamp(0.0, 1.0);
    if level == 0 {
        // The finest level passes nothing on.
        system::splat(samples, grid, level, |detail| [whole(detail)], [&mut rhs], executor, step)?;
        workspace.recycle(core::mem::take(sparse));
    } else {
        let mut own = workspace.empty(rhs.len());
        own.extend_from_slice(&rhs);
        let shares = |detail: f32| [whole(detail), max(1.0 - (detail - here).abs(), 0.0)];
        system::splat(samples, grid, level, shares, [&mut rhs, &mut own], executor, step)?;
        workspace.recycle(core::mem::replace(sparse, own));
    }
    Ok(rhs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::executor::Serial;
    use crate::point_cloud::Rank;
    use crate::progress::Silent;
    use crate::{Params, Preset, mesh};
    use studio::noise::Random;

    /// Nothing is outside.
    struct Anywhere;

    impl Envelope for Anywhere {
        fn bounds(&self) -> (Vec3, Vec3) {
            (Vec3::splat(-24.0), Vec3::splat(24.0))
        }

        fn signed_distance(&self, _: Vec3) -> f32 {
            f32::MAX
        }
    }

    /// Mean and largest distance, in voxels, of the mesh's vertices from a sphere. The points lie exactly on the
    /// sphere, two per square voxel, and are evenly or randomly distributed.
    fn errors(radius: f32, centre: Vec3, chance: bool) -> (f32, f32) {
        const TURN: f32 = 2.399_963_2;
        let count = (8.0 * core::f32::consts::PI * radius * radius) as u32;
        let mut random = Random::new(1, 0);
        let points: Vec<Point> = (0..count)
            .map(|i| {
                let (z, turn) = if chance {
                    (random.signed() as f32, random.uniform() as f32 * core::f32::consts::TAU)
                } else {
                    (1.0 - (2.0 * i as f32 + 1.0) / count as f32, i as f32 * TURN)
                };
                let ring = libm::sqrtf(1.0 - z * z);
                let normal = Vec3::new(ring * libm::cosf(turn), ring * libm::sinf(turn), z);
                let position = centre + normal * radius;
                Point { position, normal, fidelity: 1.0, sigma: 0.0, weight: 1.0, view: 0, rank: Rank::Detected }
            })
            .collect();
        let params = Params::preset(Preset::Default).meshing;
        let meshed = mesh::mesh((&points).into(), &Anywhere, 1.0, &params, &mut Workspace::default(), &Serial, &Silent)
            .expect("a sphere");
        let errors = meshed.mesh.positions.iter().map(|p| (p.distance(centre) - radius).abs());
        let (sum, worst) = errors.clone().fold((0.0, 0.0), |(sum, worst), e| (sum + e, max(worst, e)));
        (sum / errors.count() as f32, worst)
    }

    /// The surface passes exact points within hundredths of a voxel, wherever it lies between the nodes.
    #[test]
    fn exact_points_are_met() {
        for radius in [8.0, 12.7, 20.0] {
            for shift in [0.0, 0.21, 0.5] {
                let (mean, worst) = errors(radius, Vec3::new(shift, 0.3 * shift, -shift), false);
                assert!(mean < 0.007 && worst < 0.07, "radius {radius}, shift {shift}: mean {mean}, worst {worst}");
            }
        }
    }

    /// Randomly distributed points are dense in some places and sparse in others. The surface must hardly be affected.
    #[test]
    fn chance_is_evened_out() {
        let (mean, worst) = errors(20.0, Vec3::new(0.2, 0.1, -0.3), true);
        assert!(mean < 0.006 && worst < 0.07, "mean {mean}, worst {worst}");
    }
}
