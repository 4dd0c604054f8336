//! How bright each camera's pictures are against those of the others.

use super::{matching::Brightness, statistics::median};
use alloc::{vec, vec::Vec};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Comparisons of a pair below which it does not count.
const LEAST: usize = 8;
/// Precision with which the mean of all gains is held at one, against one pair of cameras.
const ANCHOR: f64 = 1e-3;

/// The gain of each camera, by place: the brightness of its pictures over the mean of all cameras, in sRGB values. `None`
/// for cameras that could not be compared.
pub(super) fn gains(cameras: usize, compared: &[Brightness]) -> Vec<Option<f64>> {
    let mut pairs: Vec<Vec<f64>> = vec![Vec::new(); cameras * cameras];
    for &(a, b, ratio) in compared.iter().filter(|(_, _, ratio)| *ratio > 0.0) {
        pairs[usize::from(a) * cameras + usize::from(b)].push(libm::log(f64::from(ratio)));
    }
    // Least squares over the logarithms.
    let mut matrix = DMatrix::from_diagonal_element(cameras, cameras, ANCHOR);
    let mut right = DVector::zeros(cameras);
    let mut is_known = vec![false; cameras];
    for (i, ratios) in pairs.iter_mut().enumerate().filter(|(_, ratios)| ratios.len() >= LEAST) {
        let (a, b) = (i / cameras, i % cameras);
        let Some(ratio) = median(ratios) else { continue };
        matrix[(a, a)] += 1.0;
        matrix[(b, b)] += 1.0;
        matrix[(a, b)] -= 1.0;
        matrix[(b, a)] -= 1.0;
        right[a] -= ratio;
        right[b] += ratio;
        (is_known[a], is_known[b]) = (true, true);
    }
    let Some(factors) = Cholesky::new(matrix) else { return vec![None; cameras] };
    let solution = factors.solve(&right);
    (0..cameras).map(|i| is_known[i].then(|| libm::exp(solution[i]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gains_explain_the_ratios() {
        let truth = [1.1, 0.9, 1.0, 1.05];
        let mut compared = Vec::new();
        for (a, b) in [(0_u16, 1_u16), (1, 2), (2, 3), (3, 0)] {
            let ratio = (truth[b as usize] / truth[a as usize]) as f32;
            (0..20).for_each(|_| compared.push((a, b, ratio)));
        }
        let found = gains(5, &compared);
        assert_eq!(found[4], None);
        for i in 1..4 {
            let ratio = found[i].unwrap() / found[0].unwrap();
            assert!((ratio - truth[i] / truth[0]).abs() < 1e-3, "{found:?}");
        }
    }
}
