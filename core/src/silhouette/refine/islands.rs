//! Small holes in the object and small specks outside it, kept or removed by their colours.

use super::{likelihoods::Likelihoods, patch::Patch};
use crate::silhouette::{
    parts::{Connected, Part, Parts},
    refill::refill,
};
use alloc::vec::Vec;

/// Mean evidence of a part's pixels that overrules the matte.
const MIN_MEAN: f32 = 1.0;
/// Parts with more than this share of the object's pixels stay.
const MAX_SHARE: f32 = 0.1;

/// Buffers of [`settle`].
#[derive(Debug, Default)]
pub(super) struct Buffers {
    parts: Parts,
    /// Sum of the evidence of each part's pixels.
    evidence: Vec<f32>,
}

/// Removes from the coverage the small holes whose colours are the object's and not the background's, and the small
/// specks whose colours are the background's and not the object's. Returns whether anything was changed.
pub(super) fn settle(
    patch: &Patch,
    distance: &[i16],
    colours: &Likelihoods,
    coverage: &mut [u8],
    buffers: &mut Buffers,
) -> bool {
    let Buffers { parts, evidence } = buffers;
    parts.find(patch.width, patch.height, Connected::Sides, |i| Some(distance[i] > 0));
    let list = &parts.list;
    let object_pixels = list.iter().filter(|p| p.inside).map(|p| p.pixels).sum::<u32>();
    let largest = list.iter().filter(|p| p.inside).map(|p| p.pixels).max().unwrap_or(0);
    let small = |part: &Part| {
        let fits = part.pixels as f32 <= MAX_SHARE * object_pixels as f32;
        fits && (part.inside && part.pixels < largest || !part.inside && !part.at_edge)
    };
    if !list.iter().any(small) {
        return false;
    }
    refill(evidence, list.len(), 0.0);
    for y in 0..patch.height {
        for x in 0..patch.width {
            let Some(part) = parts.of(y * patch.width + x) else { continue };
            if small(&list[part]) && !patch.is_clipped(x, y) {
                evidence[part] += colours.ratio(patch.bytes(x, y));
            }
        }
    }
    let mut changed = false;
    for (i, coverage) in coverage.iter_mut().enumerate() {
        let Some(number) = parts.of(i) else { continue };
        let part = &list[number];
        let mean = evidence[number] / part.pixels as f32;
        if small(part) && if part.inside { mean < -MIN_MEAN } else { mean > MIN_MEAN } {
            *coverage = if part.inside { 0 } else { 255 };
            changed = true;
        }
    }
    changed
}
