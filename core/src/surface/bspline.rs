//! The quadratic B-spline, with which the Poisson solver (§6.1) smooths and marching cubes takes gradients.

/// Values at the three nodes nearest to a point that lies `d` beyond the middle one, in units of the nodes' spacing.
#[inline]
pub(crate) fn quadratic(d: f32) -> [f32; 3] {
    let (below, above) = (0.5 - d, 0.5 + d);
    [0.5 * below * below, 0.75 - d * d, 0.5 * above * above]
}

/// Derivatives of [`quadratic`].
#[inline]
pub(crate) fn derivatives(d: f32) -> [f32; 3] {
    let (below, above) = (0.5 - d, 0.5 + d);
    [-below, -2.0 * d, above]
}
