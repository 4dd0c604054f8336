//! Robust bundle adjustment: cameras and points that explain all observations best.
//!
//! Levenberg-Marquardt steps; the points are eliminated (Schur complement), so that one linear system over the cameras
//! remains. Cauchy's loss bounds what a wrong match can do. Priors hold the cameras near the given ones: they keep the
//! gauge, so that the world neither turns, moves nor grows, and decide what the observations leave open.

use super::{
    model::{Model, PARAMETERS},
    track::{Track, loss, weight, worst_loss},
};
use alloc::vec::Vec;
use glam::{DMat3, DVec3};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Largest number of steps per scale of the loss.
const STEPS: usize = 12;
/// A step that lowers the cost by less than this share is the last one.
const CONVERGED: f64 = 1e-6;

/// What may change, and how far.
#[derive(Debug, Clone)]
pub(super) struct Priors {
    /// The cameras from which deviations count.
    pub(super) given: Vec<Model>,
    /// For each camera the inverse of the covariance of its deviation. A parameter whose diagonal element is zero stays as
    /// it is.
    pub(super) information: Vec<[[f64; PARAMETERS]; PARAMETERS]>,
}

/// The sum over the cameras of the squared deviations in standard deviations.
fn prior_cost(models: &[Model], priors: &Priors) -> f64 {
    let mut sum = 0.0;
    for ((model, given), information) in models.iter().zip(&priors.given).zip(&priors.information) {
        let deviation = model.deviation(given);
        for (row, a) in information.iter().zip(deviation) {
            for (value, b) in row.iter().zip(deviation) {
                sum += value * a * b;
            }
        }
    }
    sum
}

fn cost(models: &[Model], tracks: &[Track], points: &[DVec3], priors: &Priors, scale: f64) -> f64 {
    let mut sum = prior_cost(models, priors);
    for (track, &point) in tracks.iter().zip(points) {
        for seen in track.observations.iter().filter(|_| !track.held_out) {
            sum += match models[seen.camera as usize].project(point) {
                Some(at) => loss(seen.pixel - at, seen.sigma, scale),
                None => worst_loss(scale),
            };
        }
    }
    sum
}

/// The normal equations over the cameras, with the points eliminated.
struct Equations {
    /// Index of each camera's first free parameter, and which of its parameters are free.
    free: Vec<(usize, Vec<usize>)>,
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    /// For each track: the inverse of the point's block, its right side, and its blocks with the cameras' free
    /// parameters.
    points: Vec<Eliminated>,
}

/// What is needed to find a point's step from those of the cameras.
#[derive(Default)]
struct Eliminated {
    inverse: DMat3,
    right: DVec3,
    /// Index of the free parameter, and its derivative combined with those of the point.
    mixed: Vec<(usize, DVec3)>,
}

impl Equations {
    fn new(models: &[Model], tracks: &[Track], points: &[DVec3], priors: &Priors, scale: f64, damping: f64) -> Self {
        let mut count = 0;
        let free: Vec<(usize, Vec<usize>)> = priors
            .information
            .iter()
            .map(|information| {
                let of: Vec<usize> = (0..PARAMETERS).filter(|&k| information[k][k] > 0.0).collect();
                let first = count;
                count += of.len();
                (first, of)
            })
            .collect();
        let (mut matrix, mut right) = (DMatrix::zeros(count, count), DVector::zeros(count));
        for (i, model) in models.iter().enumerate() {
            let deviation = model.deviation(&priors.given[i]);
            let (first, parameters) = &free[i];
            for (row, &k) in parameters.iter().enumerate() {
                for (column, &l) in parameters.iter().enumerate() {
                    let value = priors.information[i][k][l];
                    right[first + row] -= value * deviation[l];
                    if column <= row {
                        matrix[(first + row, first + column)] += value;
                    }
                }
            }
        }
        // First the cameras' own blocks, which are damped, then the elimination of the points.
        let mut eliminated = Vec::with_capacity(tracks.len());
        for (track, &point) in tracks.iter().zip(points) {
            eliminated.push(if track.held_out {
                Eliminated::default()
            } else {
                gather(models, track, point, &free, scale, damping, &mut matrix, &mut right)
            });
        }
        for i in 0..count {
            matrix[(i, i)] *= 1.0 + damping;
        }
        for point in &eliminated {
            for (n, &(row, a)) in point.mixed.iter().enumerate() {
                let a = point.inverse * a;
                right[row] -= a.dot(point.right);
                // The lower triangle, which the factorisation reads.
                for &(column, b) in &point.mixed[..=n] {
                    let (low, high) = (row.min(column), row.max(column));
                    matrix[(high, low)] -= a.dot(b);
                }
            }
        }
        Self { free, matrix, right, points: eliminated }
    }

    /// The steps of the cameras and of the points; `None` if the equations are singular.
    fn solve(self) -> Option<(Vec<[f64; PARAMETERS]>, Vec<DVec3>)> {
        let solution = Cholesky::new(self.matrix)?.solve(&self.right);
        if !solution.iter().all(|v| v.is_finite()) {
            return None;
        }
        let cameras = self.free.iter().map(|(first, of)| {
            let mut step = [0.0; PARAMETERS];
            for (at, &k) in of.iter().enumerate() {
                step[k] = solution[first + at];
            }
            step
        });
        let points = self.points.iter().map(|point| {
            let rest = point.mixed.iter().fold(point.right, |rest, &(row, a)| rest - a * solution[row]);
            point.inverse * rest
        });
        Some((cameras.collect(), points.collect()))
    }
}

/// Adds a track to the cameras' blocks, and returns its point for elimination.
fn gather(
    models: &[Model],
    track: &Track,
    point: DVec3,
    free: &[(usize, Vec<usize>)],
    scale: f64,
    damping: f64,
    matrix: &mut DMatrix<f64>,
    right: &mut DVector<f64>,
) -> Eliminated {
    let mut of = Eliminated::default();
    let mut block = DMat3::ZERO;
    for seen in &track.observations {
        let Some(at) = models[seen.camera as usize].linearise(point) else { continue };
        let r = seen.pixel - at.pixel;
        let w = weight(r, seen.sigma, scale);
        let [jx, jy, jz] = at.by_point;
        let with_point = |j: glam::DVec2| DVec3::new(jx.dot(j), jy.dot(j), jz.dot(j)) * w;
        block += DMat3::from_cols(with_point(jx), with_point(jy), with_point(jz));
        of.right += with_point(r);
        let (first, parameters) = &free[seen.camera as usize];
        for (row, &k) in parameters.iter().enumerate() {
            let j = at.by_camera[k];
            of.mixed.push((first + row, with_point(j)));
            right[first + row] += w * j.dot(r);
            for (column, &l) in parameters[..=row].iter().enumerate() {
                matrix[(first + row, first + column)] += w * j.dot(at.by_camera[l]);
            }
        }
    }
    block.x_axis.x *= 1.0 + damping;
    block.y_axis.y *= 1.0 + damping;
    block.z_axis.z *= 1.0 + damping;
    of.inverse = block.inverse();
    if !of.inverse.is_finite() {
        // All its cameras have it behind them, or its rays are parallel: it says nothing.
        return Eliminated::default();
    }
    of
}

/// Moves cameras and points to where the cost is lowest, for each scale of the loss in turn.
pub(super) fn adjust(models: &mut Vec<Model>, tracks: &mut [Track], priors: &Priors, scales: &[f64]) {
    let mut points: Vec<DVec3> = tracks.iter().map(|track| track.point).collect();
    for &scale in scales {
        let mut damping = 1e-4;
        let mut now = cost(models, tracks, &points, priors, scale);
        for _ in 0..STEPS {
            let equations = Equations::new(models, tracks, &points, priors, scale, damping);
            let Some((cameras, steps)) = equations.solve() else {
                damping *= 10.0;
                continue;
            };
            let moved: Vec<Model> = models.iter().zip(&cameras).map(|(model, step)| model.moved(step)).collect();
            let placed: Vec<DVec3> = points.iter().zip(&steps).map(|(&point, &step)| point + step).collect();
            let then = cost(&moved, tracks, &placed, priors, scale);
            if !(then < now) {
                damping *= 10.0;
                if damping > 1e6 {
                    break;
                }
                continue;
            }
            let gain = (now - then) / now;
            (*models, points, now) = (moved, placed, then);
            damping = (damping * 0.1).max(1e-9);
            if gain < CONVERGED {
                break;
            }
        }
    }
    for (track, point) in tracks.iter_mut().zip(points) {
        if !track.held_out {
            track.point = point;
        }
    }
}

/// The covariance of each camera's parameters at the solution. Parameters that are not free have none.
pub(super) fn covariance(
    models: &[Model],
    tracks: &[Track],
    priors: &Priors,
    scale: f64,
) -> Option<Vec<[[f64; PARAMETERS]; PARAMETERS]>> {
    let points: Vec<DVec3> = tracks.iter().map(|track| track.point).collect();
    let Equations { free, matrix, .. } = Equations::new(models, tracks, &points, priors, scale, 0.0);
    let inverse = Cholesky::new(matrix)?.inverse();
    let of_camera = |(first, of): &(usize, Vec<usize>)| {
        let mut block = [[0.0; PARAMETERS]; PARAMETERS];
        for (row, &k) in of.iter().enumerate() {
            for (column, &l) in of.iter().enumerate() {
                block[k][l] = inverse[(first + row, first + column)];
            }
        }
        block
    };
    Some(free.iter().map(of_camera).collect())
}
