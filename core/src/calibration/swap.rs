//! Finds two cameras whose pictures are exchanged.

use super::{
    instant::Instant,
    model::Model,
    tangents::{Tangency, misses, pair},
};
use alloc::vec::Vec;

/// A camera is suspected if its contour misses by at least this much, in pixels,
const SUSPECT_PIXELS: f64 = 4.0;
/// and by this many times the median of all cameras.
const SUSPECT_RATIO: f64 = 4.0;
/// Exchanging two cameras' pictures must make both misses smaller by this factor.
const BETTER: f64 = 3.0;
/// At most so many cameras are suspected, those that miss most.
const MOST: usize = 8;

/// The two cameras, by place, whose silhouettes agree with all others much better when they are exchanged.
pub(super) fn swapped(models: &[Model], instants: &[Instant], found: &[Tangency]) -> Option<[usize; 2]> {
    let of = misses(models.len(), found);
    let mut sizes: Vec<f64> = of.iter().flatten().copied().collect();
    let limit = (SUSPECT_RATIO * super::statistics::median(&mut sizes)?).max(SUSPECT_PIXELS);
    let mut suspects: Vec<usize> = (0..models.len()).filter(|&i| of[i].is_some_and(|miss| miss > limit)).collect();
    suspects.sort_by(|&a, &b| of[b].unwrap_or(0.0).total_cmp(&of[a].unwrap_or(0.0)).then(a.cmp(&b)));
    suspects.truncate(MOST);
    let mut best: Option<(f64, [usize; 2])> = None;
    for (n, &b) in suspects.iter().enumerate() {
        for &a in &suspects[..n] {
            let exchanged = exchanged_misses(models, instants, [a, b]);
            let (Some(of_a), Some(of_b)) = (exchanged[0], exchanged[1]) else { continue };
            let is_better = |miss: f64, camera: usize| of[camera].is_some_and(|before| miss * BETTER < before);
            if is_better(of_a, a) && is_better(of_b, b) && best.is_none_or(|(least, _)| of_a + of_b < least) {
                best = Some((of_a + of_b, [a.min(b), a.max(b)]));
            }
        }
    }
    best.map(|(_, cameras)| cameras)
}

/// The median misses of two cameras with each other's pictures.
fn exchanged_misses(models: &[Model], instants: &[Instant], [a, b]: [usize; 2]) -> [Option<f64>; 2] {
    let mut found = Vec::new();
    for instant in instants {
        let mut outlines = instant.outlines.clone();
        outlines.swap(a, b);
        for other in (0..models.len()).filter(|&i| i != a && i != b) {
            pair(models, &outlines, [other.min(a), other.max(a)], &mut found);
            pair(models, &outlines, [other.min(b), other.max(b)], &mut found);
        }
    }
    let of = misses(models.len(), &found);
    [of[a], of[b]]
}
