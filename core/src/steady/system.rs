//! The linear equations of one iteration: all nodes' small turns and shifts.

use super::{moves::Motion, nodes::Nodes};
use alloc::{vec, vec::Vec};
use glam::DVec3;

/// Unknowns of a node: a small turn about its place, then a shift in pixels.
pub(super) type Step = [f64; 6];

/// The normal equations of one node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Block {
    matrix: [[f64; 6]; 6],
    right: Step,
    /// Sum of the shares of the vertices.
    pub count: f64,
}

impl Block {
    /// Adds the equation turn · `by_turn` + shift · `by_shift` = `value`.
    pub fn add(&mut self, by_turn: DVec3, by_shift: DVec3, value: f64, weight: f64) {
        let row = [by_turn.x, by_turn.y, by_turn.z, by_shift.x, by_shift.y, by_shift.z];
        for i in 0..6 {
            let scaled = weight * row[i];
            for j in 0..6 {
                self.matrix[i][j] += scaled * row[j];
            }
            self.right[i] += scaled * value;
        }
    }

    /// Divides by the number of vertices, so that all nodes count alike.
    pub fn normalise(&mut self) {
        let by = 1.0 / self.count.max(1.0);
        self.matrix.iter_mut().flatten().chain(&mut self.right).for_each(|value| *value *= by);
    }
}

pub(super) struct System<'a> {
    pub nodes: &'a Nodes,
    pub motions: &'a [Motion],
    pub blocks: &'a [Block],
    pub stiffness: f64,
}

/// Number of iterations of conjugate gradients. Later ones move nodes by a small part of a pixel.
const ITERATIONS: u32 = 40;

impl System<'_> {
    /// The steps of all nodes, by conjugate gradients.
    pub fn solve(&self) -> Vec<Step> {
        let count = self.blocks.len();
        let arms = self.arms();
        let mut residual: Vec<Step> = self.blocks.iter().map(|block| block.right).collect();
        let diagonal = self.diagonal(&arms);
        for (&[a, b], arms) in self.nodes.edges.iter().zip(&arms) {
            for (a, b, arm) in [(a as usize, b as usize, arms[0]), (b as usize, a as usize, arms[1])] {
                // How far the other node is from where this one would carry it.
                let place = |n: usize| self.nodes.places[n].as_dvec3() + self.motions[n].translation;
                let gap = arm + place(a) - place(b);
                self.scatter(&mut residual, a, b, arm, -gap);
            }
        }
        let mut x = vec![[0.0; 6]; count];
        let precondition = |r: &[Step]| -> Vec<Step> {
            r.iter().zip(&diagonal).map(|(r, d)| core::array::from_fn(|i| r[i] / d[i])).collect()
        };
        let mut z = precondition(&residual);
        let mut direction = z.clone();
        let mut rho = dot(&residual, &z);
        let start = rho;
        for _ in 0..ITERATIONS {
            if rho <= 1e-10 * start || rho <= 0.0 {
                break;
            }
            let applied = self.apply(&direction, &arms);
            let alpha = rho / dot(&direction, &applied);
            for n in 0..count {
                for i in 0..6 {
                    x[n][i] += alpha * direction[n][i];
                    residual[n][i] -= alpha * applied[n][i];
                }
            }
            z = precondition(&residual);
            let next = dot(&residual, &z);
            let beta = next / rho;
            rho = next;
            for n in 0..count {
                for i in 0..6 {
                    direction[n][i] = z[n][i] + beta * direction[n][i];
                }
            }
        }
        x
    }

    /// For each edge, from each of its nodes to where that node carries the other one.
    fn arms(&self) -> Vec<[DVec3; 2]> {
        let arm = |a: u32, b: u32| {
            let places = &self.nodes.places;
            self.motions[a as usize].rotation * (places[b as usize] - places[a as usize]).as_dvec3()
        };
        self.nodes.edges.iter().map(|&[a, b]| [arm(a, b), arm(b, a)]).collect()
    }

    /// The product of the matrix and a vector.
    fn apply(&self, x: &[Step], arms: &[[DVec3; 2]]) -> Vec<Step> {
        let product = |(block, x): (&Block, &Step)| -> Step {
            core::array::from_fn(|i| (0..6).map(|j| block.matrix[i][j] * x[j]).sum::<f64>() + DAMPING * x[i])
        };
        let mut out: Vec<Step> = self.blocks.iter().zip(x).map(product).collect();
        for (&[a, b], arms) in self.nodes.edges.iter().zip(arms) {
            for (a, b, arm) in [(a as usize, b as usize, arms[0]), (b as usize, a as usize, arms[1])] {
                let stretch = turn(&x[a]).cross(arm) + shift(&x[a]) - shift(&x[b]);
                self.scatter(&mut out, a, b, arm, stretch);
            }
        }
        out
    }

    /// Adds the transposed equations of an edge, times `value`.
    fn scatter(&self, out: &mut [Step], a: usize, b: usize, arm: DVec3, value: DVec3) {
        let value = value * self.stiffness;
        let by_turn = arm.cross(value);
        for (i, v) in [by_turn.x, by_turn.y, by_turn.z, value.x, value.y, value.z].into_iter().enumerate() {
            out[a][i] += v;
        }
        for (i, v) in [value.x, value.y, value.z].into_iter().enumerate() {
            out[b][3 + i] -= v;
        }
    }

    /// The diagonal of the matrix.
    fn diagonal(&self, arms: &[[DVec3; 2]]) -> Vec<Step> {
        let own = |block: &Block| core::array::from_fn(|i| block.matrix[i][i] + DAMPING);
        let mut out: Vec<Step> = self.blocks.iter().map(own).collect();
        for (&[a, b], arms) in self.nodes.edges.iter().zip(arms) {
            for (a, b, arm) in [(a as usize, b as usize, arms[0]), (b as usize, a as usize, arms[1])] {
                let square = DVec3::splat(arm.length_squared()) - arm * arm;
                for i in 0..3 {
                    out[a][i] += self.stiffness * square[i];
                    out[a][3 + i] += self.stiffness;
                    out[b][3 + i] += self.stiffness;
                }
            }
        }
        out
    }
}

/// Keeps the equations of nodes solvable that nothing pulls.
const DAMPING: f64 = 1e-3;

fn turn(step: &Step) -> DVec3 {
    DVec3::new(step[0], step[1], step[2])
}

fn shift(step: &Step) -> DVec3 {
    DVec3::new(step[3], step[4], step[5])
}

fn dot(a: &[Step], b: &[Step]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (0..6).map(|i| a[i] * b[i]).sum::<f64>()).sum()
}
