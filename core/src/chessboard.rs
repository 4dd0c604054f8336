//! Chessboard distance transform.

/// Replaces each value by the smallest value of any pixel plus the chessboard distance to it, in place. The outermost
/// pixels keep their values. Features hold 0 or 1, and all other pixels the largest distance of interest.
///
/// Two sweeps are exact for this metric (Rosenfeld & Pfaltz, Distance Functions on Digital Pictures, 1968).
pub(crate) fn spread(width: usize, height: usize, distance: &mut [u8]) {
    let lower = |distance: &mut [u8], i: usize, from: [usize; 4]| {
        let nearest = from.into_iter().map(|j| distance[j]).min().unwrap_or(u8::MAX - 1);
        distance[i] = distance[i].min(nearest + 1);
    };
    let inner = |size: usize| 1..size.max(1) - 1;
    for y in inner(height) {
        for x in inner(width) {
            let i = y * width + x;
            lower(distance, i, [i - width - 1, i - width, i - width + 1, i - 1]);
        }
    }
    for y in inner(height).rev() {
        for x in inner(width).rev() {
            let i = y * width + x;
            lower(distance, i, [i + width - 1, i + width, i + width + 1, i + 1]);
        }
    }
}
