//! The picture's border.

use core::ops::Range;

/// Width of the picture's border, as a share of its longer side.
const BORDER: f32 = 0.04;
/// A wall covers at least this share of one side of the border, and of its two corners, which are squares of this share of
/// its length. An object that leaves the picture covers a side's middle. On a dark wall, noise is paint here and there.
const WALL: f32 = 0.5;
const CORNER: f32 = 0.15;

/// Width of the border in pixels.
fn border(w: usize, h: usize) -> usize {
    ((BORDER * w.max(h) as f32) as usize).clamp(1, w.min(h))
}

/// Whether a pixel is nearer to the picture's edge than the border is wide.
pub(in crate::silhouette) fn is_border(w: usize, h: usize, i: usize) -> bool {
    let (x, y, edge) = (i % w, i / w, border(w, h));
    x.min(w - 1 - x) < edge || y.min(h - 1 - y) < edge
}

/// Whether pixels of a set cover most of one side of the border and of its corners.
pub(super) fn spans_a_side(w: usize, h: usize, is_in: impl Fn(usize) -> bool) -> bool {
    let covered = |xs: Range<usize>, ys: Range<usize>| {
        let pixels = xs.len() * ys.len();
        let found = ys.map(|y| xs.clone().filter(|x| is_in(y * w + x)).count()).sum::<usize>();
        found as f32 > WALL * pixels as f32
    };
    let edge = border(w, h);
    let corner = ((CORNER * w.min(h) as f32) as usize).max(1);
    let (left, right, top, bottom) = (0..corner, w - corner..w, 0..corner, h - corner..h);
    let corners = [(&left, &top), (&right, &top), (&left, &bottom), (&right, &bottom)];
    let [lt, rt, lb, rb] = corners.map(|(xs, ys)| covered(xs.clone(), ys.clone()));
    (lt && rt && covered(0..w, 0..edge))
        || (lb && rb && covered(0..w, h - edge..h))
        || (lt && lb && covered(0..edge, 0..h))
        || (rt && rb && covered(w - edge..w, 0..h))
}
