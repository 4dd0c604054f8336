//! The part of the object whose colours the backdrop does not have.

use super::likeness::{Likeness, is_border};
use super::{colours::Colours, histogram::Histogram, parts, potts};
use alloc::vec::Vec;

/// A colour is rare if a pixel of the border has its bin with less than this probability.
const RARE: f32 = 2e-5;
/// Evidence of a single pixel counts up to this logarithm of the likelihood ratio.
pub(super) const CLAMP: f32 = 4.0;
/// Parts with less than these shares of the largest part's pixels are none of the object: at first, and after that.
const FIRST_PART: f32 = 0.2;
pub(super) const PART: f32 = 0.1;
const ROUNDS: usize = 3;

/// Finds the core: at first the pixels whose colours are rare at the picture's border. Then the colours of object and
/// backdrop are learned in turns. `None` if there is no such pixel.
pub(super) fn find(w: usize, h: usize, colours: &Colours, likeness: &[Likeness]) -> Option<Vec<bool>> {
    let bin = |i: usize| colours.bin(i, 0.0);
    let border = Histogram::new((0..w * h).filter(|&i| is_border(w, h, i)).map(|i| (bin(i), 1.0)));
    let rare = |i: usize| likeness[i] == Likeness::Other && border.probability(bin(i)) < RARE;
    // Single pixels are noise: a core pixel has three neighbours in a row and in a column, or touches one that has.
    let inner = |i: usize| {
        let (x, y) = (i % w, i / w);
        let within = x > 0 && x + 1 < w && y > 0 && y + 1 < h;
        within && [i - w, i - 1, i, i + 1, i + w].into_iter().all(rare)
    };
    let mut core = alloc::vec![false; w * h];
    for i in (0..w * h).filter(|&i| inner(i)) {
        [i - w, i - 1, i, i + 1, i + w].into_iter().for_each(|j| core[j] = true);
    }
    parts::keep_large(w, h, &mut core, FIRST_PART);
    for _ in 0..ROUNDS {
        let count = |label: bool| Histogram::new((0..w * h).filter(|&i| core[i] == label).map(|i| (bin(i), 1.0)));
        let (front, back) = (count(true), count(false));
        if front.total == 0.0 {
            return None;
        }
        let of_bin = front.ratios(&back, CLAMP);
        let evidence: Vec<f32> =
            (0..w * h).map(|i| if likeness[i] == Likeness::Paint { -CLAMP } else { of_bin[bin(i)] }).collect();
        core = potts::label(w, h, &evidence);
        parts::keep_large(w, h, &mut core, PART);
    }
    core.contains(&true).then_some(core)
}
