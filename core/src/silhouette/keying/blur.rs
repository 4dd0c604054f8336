//! Blurs of a plane of numbers. Pixels beyond the picture repeat its edge.

use alloc::vec;

/// Replaces a plane by its mean over squares of `2 radius + 1` pixels, twice. The standard deviation of this window is
/// about 0.8 (radius + 1/2) pixels.
pub(super) fn blur(w: usize, h: usize, plane: &mut [f32], radius: usize) {
    let mut out = vec![0.0f32; w * h];
    let mut sums = vec![0.0f32; w];
    for _ in 0..2 {
        for y in 0..h {
            mean(&plane[y * w..][..w], radius, &mut out[y * w..][..w]);
        }
        columns(w, h, &out, radius, &mut sums, plane);
    }
}

/// Means of columns. `sums` holds the sum of each column's window.
fn columns(w: usize, h: usize, plane: &[f32], radius: usize, sums: &mut [f32], out: &mut [f32]) {
    let scale = 1.0 / (2 * radius + 1) as f32;
    let row = |y: usize| &plane[y.min(h - 1) * w..][..w];
    sums.fill(0.0);
    for k in 0..=2 * radius {
        sums.iter_mut().zip(row(k.saturating_sub(radius))).for_each(|(sum, v)| *sum += v);
    }
    for y in 0..h {
        let (enters, leaves) = (row(y + radius + 1), row(y.saturating_sub(radius)));
        for (x, out) in out[y * w..][..w].iter_mut().enumerate() {
            *out = sums[x] * scale;
            sums[x] += enters[x] - leaves[x];
        }
    }
}

/// Means of a row.
fn mean(line: &[f32], radius: usize, out: &mut [f32]) {
    let n = line.len();
    let scale = 1.0 / (2 * radius + 1) as f32;
    let at = |i: usize| line[i.saturating_sub(radius).min(n - 1)];
    // The sum of the window around the first pixel.
    let mut sum: f32 = (0..=2 * radius).map(at).sum();
    for (i, out) in out.iter_mut().enumerate() {
        *out = sum * scale;
        sum += line[(i + radius + 1).min(n - 1)] - line[i.saturating_sub(radius)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blur_keeps_what_is_even_and_spreads_what_is_not() {
        let mut even = vec![3.0; 30 * 20];
        blur(30, 20, &mut even, 4);
        assert!(even.iter().all(|v| (v - 3.0f32).abs() < 1e-4));
        let mut spot = vec![0.0; 41 * 41];
        spot[20 * 41 + 20] = 1.0;
        blur(41, 41, &mut spot, 4);
        assert!((spot.iter().sum::<f32>() - 1.0).abs() < 1e-4);
        let variance: f32 = (0..41 * 41).map(|i| spot[i] * (i as f32 % 41.0 - 20.0) * (i as f32 % 41.0 - 20.0)).sum();
        assert!((variance - 2.0 * 80.0 / 12.0).abs() < 0.01, "{variance}");
    }
}
