//! Which side of the contour the pixels near a matte's edge belong to.

use super::{colour_model::ColourModel, patch::Patch};
use crate::silhouette::distance::UNITS;
use alloc::{vec, vec::Vec};

/// Limit of one pixel's evidence. Evidence is the logarithm of a likelihood ratio, positive for the object.
const MAX_EVIDENCE: f32 = 6.0;
/// Evidence of the matte per pixel of distance from its contour, and its limit: a matte that is right nearly everywhere
/// may still lack a piece.
const PRIOR_PER_PIXEL: f32 = 1.0;
const MAX_PRIOR: f32 = 3.0;
/// Evidence that overrules a matte.
const MIN_EVIDENCE: f32 = 1.5;

/// Moves the contour of a matte over pixels whose colours, and whose neighbours' colours, belong to the other side. Such
/// pixels lie within `reach` pixels of the contour, and touch it or other pixels that moved: no new holes or specks
/// appear. Returns the number of moved pixels in the outer half of the reach.
pub(super) fn relabel(patch: &Patch, distance: &[i16], model: &ColourModel, reach: f32, coverage: &mut [u8]) -> usize {
    let (w, h) = (patch.width, patch.height);
    let pixels = |i: usize| f32::from(distance[i]) / UNITS;
    let mut evidence = vec![0.0f32; patch.len()];
    let mut alphas = vec![0u8; patch.len()];
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            let d = pixels(i);
            let prior = (PRIOR_PER_PIXEL * d).clamp(-MAX_PRIOR, MAX_PRIOR);
            if d.abs() > reach + 2.0 {
                evidence[i] = 2.0 * prior;
                continue;
            }
            let local = model.at(x, y);
            let alpha = local.alpha(patch.colour(x, y));
            let colour_evidence =
                if patch.is_clipped(x, y) { 0.0 } else { (local.j * (alpha - 0.5)).clamp(-MAX_EVIDENCE, MAX_EVIDENCE) };
            evidence[i] = colour_evidence + prior;
            alphas[i] = (alpha.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        }
    }
    let evidence = binomial(w, h, &evidence);
    let overruled = |i: usize| {
        let against = if distance[i] > 0 { -evidence[i] } else { evidence[i] };
        against > MIN_EVIDENCE && pixels(i).abs() <= reach
    };
    // The pixels next to the contour first, then their neighbours.
    let mut open: Vec<u32> = Vec::new();
    let mut moved = vec![false; patch.len()];
    for y in 1..h.saturating_sub(1) {
        for x in 1..w.saturating_sub(1) {
            let i = y * w + x;
            let inside = distance[i] > 0;
            let at_contour = [i - 1, i + 1, i - w, i + w].into_iter().any(|j| (distance[j] > 0) != inside);
            if at_contour && overruled(i) {
                moved[i] = true;
                open.push(i as u32);
            }
        }
    }
    let mut far = 0;
    while let Some(i) = open.pop() {
        let i = i as usize;
        let inside = distance[i] > 0;
        coverage[i] = if inside { alphas[i].min(127) } else { alphas[i].max(128) };
        far += usize::from(pixels(i).abs() > 0.5 * reach);
        let (x, y) = (i % w, i / w);
        let near = [(x > 0, i.wrapping_sub(1)), (x + 1 < w, i + 1), (y > 0, i.wrapping_sub(w)), (y + 1 < h, i + w)];
        for (within, j) in near {
            if within && !moved[j] && (distance[j] > 0) == inside && overruled(j) {
                moved[j] = true;
                open.push(j as u32);
            }
        }
    }
    far
}

/// Smooths by 1 2 1 along both axes; the outermost pixels repeat beyond the edge.
fn binomial(width: usize, height: usize, plane: &[f32]) -> Vec<f32> {
    let mut half = vec![0.0; plane.len()];
    for (row, out) in plane.chunks_exact(width).zip(half.chunks_exact_mut(width)) {
        for x in 0..width {
            out[x] = 0.25 * (row[x.saturating_sub(1)] + 2.0 * row[x] + row[(x + 1).min(width - 1)]);
        }
    }
    let mut out = Vec::with_capacity(plane.len());
    for y in 0..height {
        let [above, row, below] =
            [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|y| &half[y * width..][..width]);
        out.extend((0..width).map(|x| 0.25 * (above[x] + 2.0 * row[x] + below[x])));
    }
    out
}
