//! The part of the object whose colours the backdrop does not have.

use super::{border::is_border, colours::Colours, histogram::Histogram, likeness::Likeness, potts};
use crate::silhouette::parts;
use alloc::{vec, vec::Vec};

/// A colour is rare if a pixel of the border has its bin with less than this probability.
const RARE: f32 = 2e-5;
/// Evidence of a single pixel counts up to this logarithm of the likelihood ratio: a pixel that reaches it is certain, and
/// its neighbours cannot overrule it.
pub(super) const CLAMP: f32 = potts::DECISIVE;
/// Parts with less than these shares of the largest part's pixels are none of the object: at first, and after that.
const FIRST_PART: f32 = 0.2;
pub(super) const PART: f32 = 0.1;
const ROUNDS: usize = 3;

/// Finds the core: at first the pixels whose colours are rare at the picture's border. Then the colours of object and
/// backdrop are learned in turns. `None` if there is no such pixel.
pub(super) fn find(w: usize, h: usize, colours: &Colours, likeness: &[Likeness]) -> Option<Vec<bool>> {
    let bin = |i: usize| colours.bin(i, 0.0);
    let border = Histogram::of_pixels((0..w * h).filter(|&i| is_border(w, h, i)), bin);
    let rare = |i: usize| likeness[i] == Likeness::Other && border.probability(bin(i)) < RARE;
    // Single pixels are noise: a core pixel has three neighbours in a row and in a column, or touches one that has.
    let inner = |i: usize| {
        let (x, y) = (i % w, i / w);
        let within = x > 0 && x + 1 < w && y > 0 && y + 1 < h;
        within && [i - w, i - 1, i, i + 1, i + w].into_iter().all(rare)
    };
    let mut core = vec![false; w * h];
    for i in (0..w * h).filter(|&i| inner(i)) {
        [i - w, i - 1, i, i + 1, i + w].into_iter().for_each(|j| core[j] = true);
    }
    parts::keep_large(w, h, &mut core, FIRST_PART);
    for _ in 0..ROUNDS {
        let [front, back] = Histogram::of_sides(&core, bin);
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
