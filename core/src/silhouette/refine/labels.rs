//! Which side of the contour the pixels near a matte's edge belong to.

use super::{colour_model::ColourModel, confusion::Confusion, patch::Patch};
use crate::silhouette::{refill::refill, stored::UNITS};
use alloc::{collections::VecDeque, vec::Vec};

/// Limit of one pixel's evidence. Evidence is the logarithm of a likelihood ratio, positive for the object.
const MAX_EVIDENCE: f32 = 6.0;
/// Evidence of the matte per pixel of distance from its contour, and its limit: a matte that is right nearly everywhere
/// may still lack a piece.
const PRIOR_PER_PIXEL: f32 = 1.0;
const MAX_PRIOR: f32 = 3.0;
/// Evidence that overrules a matte.
const MIN_EVIDENCE: f32 = 1.5;

/// Buffers of [`relabel`].
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    /// Evidence, and its smoothing along the rows only.
    pub planes: &'a mut [Vec<f32>; 2],
    /// The object's share in each pixel.
    pub alphas: &'a mut Vec<u8>,
    pub confusion: &'a mut Confusion,
    pub moved: &'a mut Vec<bool>,
    pub open: &'a mut VecDeque<u32>,
}

/// Moves the contour of a matte over pixels whose colours, and whose neighbours' colours, belong to the other side. Such
/// pixels lie within `reach` pixels of the contour, and touch it or other pixels that moved: no new holes or specks
/// appear. Returns the number of moved pixels in the outer half of the reach.
pub(super) fn relabel(
    patch: &Patch,
    distance: &[i16],
    model: &ColourModel,
    reach: f32,
    coverage: &mut [u8],
    buffers: Buffers,
) -> usize {
    let Buffers { planes: [evidence, half], alphas, confusion, moved, open } = buffers;
    let (w, h) = (patch.width, patch.height);
    let pixels = |i: usize| f32::from(distance[i]) / UNITS;
    let seen = reach + 2.0;
    refill(evidence, patch.len(), 0.0);
    refill(half, patch.len(), 0.0);
    refill(alphas, patch.len(), 0);
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            if pixels(i).abs() > seen.max(Confusion::REACH) {
                continue;
            }
            let local = model.at(x, y);
            let alpha = local.alpha(patch.colour(x, y));
            half[i] = alpha;
            if !patch.is_clipped(x, y) {
                evidence[i] = (local.j * (alpha - 0.5)).clamp(-MAX_EVIDENCE, MAX_EVIDENCE);
            }
            alphas[i] = (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        }
    }
    confusion.count(patch, distance, seen, half, evidence);
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            let d = pixels(i);
            let prior = (PRIOR_PER_PIXEL * d).clamp(-MAX_PRIOR, MAX_PRIOR);
            evidence[i] = prior + if d.abs() <= seen { confusion.limit(x, y, evidence[i]) } else { prior };
        }
    }
    binomial(w, h, evidence, half);
    let overruled = |i: usize| {
        let against = if distance[i] > 0 { -evidence[i] } else { evidence[i] };
        against > MIN_EVIDENCE && pixels(i).abs() <= reach
    };
    // The pixels next to the contour first, then their neighbours.
    refill(moved, patch.len(), false);
    for y in 1..h.saturating_sub(1) {
        for x in 1..w.saturating_sub(1) {
            let i = y * w + x;
            let inside = distance[i] > 0;
            let at_contour = [i - 1, i + 1, i - w, i + w].into_iter().any(|j| (distance[j] > 0) != inside);
            if at_contour && overruled(i) {
                moved[i] = true;
                open.push_back(i as u32);
            }
        }
    }
    let mut far = 0;
    while let Some(i) = open.pop_front() {
        let i = i as usize;
        let inside = distance[i] > 0;
        coverage[i] = if inside { alphas[i].min(127) } else { alphas[i].max(128) };
        far += usize::from(pixels(i).abs() > 0.5 * reach);
        let (x, y) = (i % w, i / w);
        let near = [(x > 0, i.wrapping_sub(1)), (x + 1 < w, i + 1), (y > 0, i.wrapping_sub(w)), (y + 1 < h, i + w)];
        for (within, j) in near {
            if within && !moved[j] && (distance[j] > 0) == inside && overruled(j) {
                moved[j] = true;
                open.push_back(j as u32);
            }
        }
    }
    far
}

/// Smooths by 1 2 1 along both axes; the outermost pixels repeat beyond the edge. `half` is a buffer.
fn binomial(width: usize, height: usize, plane: &mut [f32], half: &mut Vec<f32>) {
    refill(half, plane.len(), 0.0);
    for (row, out) in plane.chunks_exact(width).zip(half.chunks_exact_mut(width)) {
        for x in 0..width {
            out[x] = 0.25 * (row[x.saturating_sub(1)] + 2.0 * row[x] + row[(x + 1).min(width - 1)]);
        }
    }
    for (y, out) in plane.chunks_exact_mut(width).enumerate() {
        let [above, row, below] =
            [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| &half[y * width..][..width]);
        for (x, out) in out.iter_mut().enumerate() {
            *out = 0.25 * (above[x] + 2.0 * row[x] + below[x]);
        }
    }
}
