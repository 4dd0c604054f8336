//! How a wall's light varies over the picture.

use crate::linear::solve_symmetric;

/// Terms 1, x, y, x², xy, y² of a polynomial.
const TERMS: usize = 6;
/// Differences of logarithms from which a pixel counts less: it is not wall, or something bright on it.
const ROBUST: f64 = 0.1;
const ROUNDS: usize = 3;
/// Every pixel in this many rows and columns is a sample.
const STRIDE: usize = 3;

/// A polynomial of degree two through logarithms of light. Coordinates are in widths of the picture from its centre.
pub(super) struct LightField {
    w: usize,
    h: usize,
    factors: [f64; TERMS],
}

impl LightField {
    /// The field of the pixels that are `sampled`. `light` gives a pixel's logarithm. Robust against a minority of pixels
    /// of another brightness.
    pub fn fit(w: usize, h: usize, sampled: impl Fn(usize) -> bool, light: impl Fn(usize) -> f32) -> Self {
        let mut field = Self { w, h, factors: [0.0; TERMS] };
        for round in 0..ROUNDS {
            let (mut matrix, mut right) = ([0.0f64; TERMS * TERMS], [0.0f64; TERMS]);
            for y in (0..h).step_by(STRIDE) {
                for x in (0..w).step_by(STRIDE) {
                    let i = y * w + x;
                    if !sampled(i) {
                        continue;
                    }
                    let terms = field.terms(x, y);
                    let value = f64::from(light(i));
                    let off = if round == 0 { 0.0 } else { (value - field.sum(&terms)) / ROBUST };
                    let weight = 1.0 / (1.0 + off * off);
                    for r in 0..TERMS {
                        (0..TERMS).for_each(|c| matrix[r * TERMS + c] += weight * terms[r] * terms[c]);
                        right[r] += weight * terms[r] * value;
                    }
                }
            }
            field.factors = solve(matrix, right);
        }
        field
    }

    /// By how much the logarithm of light at a pixel exceeds that at the picture's centre.
    pub fn at(&self, i: usize) -> f32 {
        (self.sum(&self.terms(i % self.w, i / self.w)) - self.factors[0]) as f32
    }

    fn terms(&self, x: usize, y: usize) -> [f64; TERMS] {
        let scale = self.w as f64;
        let (x, y) = (x as f64 / scale - 0.5, (y as f64 - 0.5 * self.h as f64) / scale);
        [1.0, x, y, x * x, x * y, y * y]
    }

    fn sum(&self, terms: &[f64; TERMS]) -> f64 {
        terms.iter().zip(&self.factors).map(|(t, f)| t * f).sum()
    }
}

/// Solves normal equations. A little of the diagonal is added, so that terms that the samples do not determine become 0.
fn solve(mut matrix: [f64; TERMS * TERMS], mut right: [f64; TERMS]) -> [f64; TERMS] {
    for k in 0..TERMS {
        let diagonal = &mut matrix[k * TERMS + k];
        *diagonal = *diagonal * (1.0 + 1e-6) + 1e-6;
    }
    solve_symmetric(&mut matrix, &mut right);
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_is_that_of_the_wall_although_a_part_is_something_else() {
        const W: usize = 120;
        let truth = |x: f32, y: f32| 3.0 + 0.4 * x - 0.5 * x * x + 0.3 * y;
        let at = |i: usize| ((i % W) as f32 / W as f32 - 0.5, ((i / W) as f32 - 40.0) / W as f32);
        let light = |i: usize| truth(at(i).0, at(i).1) + if i % W > 50 && i % W < 65 { 1.0 } else { 0.0 };
        let field = LightField::fit(W, 80, |_| true, light);
        for i in 0..W * 80 {
            let expected = truth(at(i).0, at(i).1) - truth(0.0, 0.0);
            assert!((field.at(i) - expected).abs() < 0.03, "{i}: {} {expected}", field.at(i));
        }
    }
}
