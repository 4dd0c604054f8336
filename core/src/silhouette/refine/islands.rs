//! Small holes in the object and small specks outside it, kept or removed by their colours.

use super::{likelihoods::Likelihoods, patch::Patch, refill::refill};
use alloc::{collections::VecDeque, vec::Vec};

/// Mean evidence of a part's pixels that overrules the matte.
const MIN_MEAN: f32 = 1.0;
/// Parts with more than this share of the object's pixels stay.
const MAX_SHARE: f32 = 0.1;

/// Removes from the coverage the small holes whose colours are the object's and not the background's, and the small
/// specks whose colours are the background's and not the object's. Returns whether anything was changed.
pub(super) fn settle(
    patch: &Patch,
    distance: &[i16],
    colours: &Likelihoods,
    coverage: &mut [u8],
    parts: &mut Parts,
    open: &mut VecDeque<u32>,
) -> bool {
    parts.find(patch.width, patch.height, distance, open);
    let Parts { labels, list, evidence } = parts;
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
            let label = labels[y * patch.width + x] as usize;
            if small(&list[label]) && !patch.is_clipped(x, y) {
                evidence[label] += colours.ratio(patch.bytes(x, y));
            }
        }
    }
    let mut changed = false;
    for (i, coverage) in coverage.iter_mut().enumerate() {
        let label = labels[i] as usize;
        let part = &list[label];
        let mean = evidence[label] / part.pixels as f32;
        if small(part) && if part.inside { mean < -MIN_MEAN } else { mean > MIN_MEAN } {
            *coverage = if part.inside { 0 } else { 255 };
            changed = true;
        }
    }
    changed
}

/// A connected part of one side.
#[derive(Debug)]
struct Part {
    inside: bool,
    pixels: u32,
    /// Whether it reaches the patch's edge.
    at_edge: bool,
}

/// The connected parts of both sides.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// Each pixel's part.
    labels: Vec<u32>,
    list: Vec<Part>,
    /// Sum of the evidence of each part's pixels.
    evidence: Vec<f32>,
}

impl Parts {
    /// Finds them. Diagonal neighbours are not connected. `open` is a buffer: taken first in, first out, it stays short.
    fn find(&mut self, width: usize, height: usize, distance: &[i16], open: &mut VecDeque<u32>) {
        const NONE: u32 = u32::MAX;
        let Self { labels, list, .. } = self;
        refill(labels, width * height, NONE);
        list.clear();
        for start in 0..width * height {
            if labels[start] != NONE {
                continue;
            }
            let (label, inside) = (list.len() as u32, distance[start] > 0);
            let mut part = Part { inside, pixels: 0, at_edge: false };
            labels[start] = label;
            open.push_back(start as u32);
            while let Some(i) = open.pop_front() {
                let i = i as usize;
                part.pixels += 1;
                let (x, y) = (i % width, i / width);
                part.at_edge |= x == 0 || y == 0 || x + 1 == width || y + 1 == height;
                let near = [
                    (x > 0, i.wrapping_sub(1)),
                    (x + 1 < width, i + 1),
                    (y > 0, i.wrapping_sub(width)),
                    (y + 1 < height, i + width),
                ];
                for (within, j) in near {
                    if within && labels[j] == NONE && (distance[j] > 0) == inside {
                        labels[j] = label;
                        open.push_back(j as u32);
                    }
                }
            }
            list.push(part);
        }
    }
}
