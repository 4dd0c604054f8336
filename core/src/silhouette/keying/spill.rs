//! Light that the backdrop throws on the object.

use super::likeness::Likeness;
use super::{colours::Colours, histogram::Histogram, potts};
use alloc::vec::Vec;

/// Pixels at most this far from the paint may be mixtures of it and the object. They stay as they are.
const MIXED: usize = 2;
/// Evidence of a single pixel counts up to this logarithm of the likelihood ratio, so that its neighbours can overrule it.
const CLAMP: f32 = 3.9;

/// Adds to the object the pixels that are similar to the paint, lie away from it, and have colours that are more frequent
/// on the object than on the backdrop.
pub(super) fn add(w: usize, colours: &Colours, likeness: &[Likeness], object: Vec<bool>) -> Vec<bool> {
    let h = likeness.len() / w;
    let count =
        |label: bool| Histogram::new((0..w * h).filter(|&i| object[i] == label).map(|i| (colours.bin(i, 0.0), 1.0)));
    let (front, back) = (count(true), count(false));
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
