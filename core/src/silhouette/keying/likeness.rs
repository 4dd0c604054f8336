//! How pixels compare with the painted backdrop, and which are near the picture's edge.

/// Width of the picture's border, as a share of its longer side.
const BORDER: f32 = 0.04;

/// How a pixel compares with the painted backdrop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::silhouette) enum Likeness {
    /// As near to the paint's colour as the paint itself varies.
    Paint,
    /// Within the tolerance, but farther from the paint than the paint varies.
    Similar,
    /// Another colour.
    Other,
}

/// Width of the border in pixels.
pub(super) fn border(w: usize, h: usize) -> usize {
    ((BORDER * w.max(h) as f32) as usize).clamp(1, w.min(h))
}

/// Whether a pixel is nearer to the picture's edge than the border is wide.
pub(in crate::silhouette) fn is_border(w: usize, h: usize, i: usize) -> bool {
    let (x, y, edge) = (i % w, i / w, border(w, h));
    x.min(w - 1 - x) < edge || y.min(h - 1 - y) < edge
}
