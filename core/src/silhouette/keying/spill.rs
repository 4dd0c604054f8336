//! Light that the backdrop throws on the object.

use super::{colours::Colours, histogram::Histogram, likeness::Likeness, potts};
use alloc::vec::Vec;

/// Pixels at most this far from the paint may be mixtures of it and the object. They stay as they are.
const MIXED: usize = 2;
/// Evidence of a single pixel counts up to this logarithm of the likelihood ratio. It is a little less than what is decisive,
/// so that eight neighbours that agree overrule any pixel.
const CLAMP: f32 = potts::DECISIVE - 0.1;

/// Adds to the object the pixels that are similar to the paint, lie away from it, and have colours that are more frequent
/// on the object than on the backdrop.
pub(super) fn add(w: usize, colours: &Colours, likeness: &[Likeness], object: Vec<bool>) -> Vec<bool> {
    let h = likeness.len() / w;
    let [front, back] = Histogram::of_sides(&object, |i| colours.bin(i, 0.0));
    if front.total == 0.0 {
        return object;
    }
    let of_bin = front.ratios(&back, CLAMP);
    let is_away = |i: usize| {
        let (x, y) = (i % w, i / w);
        let mut rows = y.saturating_sub(MIXED)..(y + MIXED + 1).min(h);
        rows.all(|y| (x.saturating_sub(MIXED)..(x + MIXED + 1).min(w)).all(|x| likeness[y * w + x] != Likeness::Paint))
    };
    let evidence: Vec<f32> = (0..w * h)
        .map(|i| match (object[i], likeness[i]) {
            (true, _) => f32::INFINITY,
            (false, Likeness::Similar) if is_away(i) => of_bin[colours.bin(i, 0.0)],
            _ => f32::NEG_INFINITY,
        })
        .collect();
    potts::label(w, h, &evidence)
}
