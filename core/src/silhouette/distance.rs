//! Signed distance to the half-coverage contour of a mask, exact to a fraction of a pixel.

use super::Silhouette;
use alloc::{vec, vec::Vec};

/// Weights of the 5-tap binomial that takes the pixel staircase off a binary mask's contour (σ = 1 pixel).
const BINOMIAL: [i32; 5] = [1, 4, 6, 4, 1];

/// Nearest contour point of a pixel, found so far.
#[derive(Clone, Copy)]
struct Nearest {
    x: f32,
    y: f32,
    squared: f32,
}

const FAR: Nearest = Nearest { x: 0.0, y: 0.0, squared: f32::INFINITY };

/// Signed distance in 1/64 pixel, positive where coverage is more than a half.
pub(super) fn signed_distance(width: usize, height: usize, coverage: &[u8]) -> Vec<i16> {
    let smooth = smooth(width, height, coverage);
    let mut nearest = vec![FAR; width * height];
    seed(width, height, &smooth, &mut nearest);
    propagate(width, height, &mut nearest);
    let limit = 511.0 * Silhouette::UNITS;
    nearest
        .iter()
        .zip(&smooth)
        .map(|(n, &s)| {
            let d = libm::roundf((libm::sqrtf(n.squared) * Silhouette::UNITS).min(limit)) as i16;
            if s > 0 { d } else { -d }
        })
        .collect()
}

/// Binomially smoothed coverage minus one half, in units of 1/65280 (never zero: ties belong to the background).
fn smooth(width: usize, height: usize, coverage: &[u8]) -> Vec<i32> {
    let clamp = |i: usize, d: usize, n: usize| (i + d).saturating_sub(2).min(n - 1);
    let mut rows = vec![0i32; width * height];
    for y in 0..height {
        let row = &coverage[y * width..][..width];
        for x in 0..width {
            rows[y * width + x] = (0..5).map(|k| BINOMIAL[k] * i32::from(row[clamp(x, k, width)])).sum();
        }
    }
    let mut out = vec![0i32; width * height];
    for y in 0..height {
        for x in 0..width {
            let sum: i32 = (0..5).map(|k| BINOMIAL[k] * rows[clamp(y, k, height) * width + x]).sum();
            let centred = sum - 32640;
            out[y * width + x] = if centred == 0 { -1 } else { centred };
        }
    }
    out
}

/// Gives the pixels next to the contour their distance to the contour's segments in the cells that they touch.
fn seed(width: usize, height: usize, smooth: &[i32], nearest: &mut [Nearest]) {
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            let i = y * width + x;
            // Corners around the cell and the crossings on the edges between them.
            let corners = [(i, 0.0, 0.0), (i + 1, 1.0, 0.0), (i + width + 1, 1.0, 1.0), (i + width, 0.0, 1.0)];
            let mut crossings = [(0.0f32, 0.0f32); 4];
            let mut count = 0;
            for k in 0..4 {
                let (a, ax, ay) = corners[k];
                let (b, bx, by) = corners[(k + 1) % 4];
                let (sa, sb) = (smooth[a] as f32, smooth[b] as f32);
                if (sa > 0.0) != (sb > 0.0) {
                    let t = sa / (sa - sb);
                    crossings[count] = (x as f32 + ax + (bx - ax) * t, y as f32 + ay + (by - ay) * t);
                    count += 1;
                }
            }
            for pair in crossings[..count].chunks_exact(2) {
                // A pixel near the segment may belong to a neighbouring cell: update the ring around it as well.
                for py in y.saturating_sub(1)..(y + 3).min(height) {
                    for px in x.saturating_sub(1)..(x + 3).min(width) {
                        improve(&mut nearest[py * width + px], px as f32, py as f32, pair[0], pair[1]);
                    }
                }
            }
        }
    }
}

/// Takes the nearest point of a segment if it is nearer than what is known.
fn improve(n: &mut Nearest, px: f32, py: f32, a: (f32, f32), b: (f32, f32)) {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let length = dx * dx + dy * dy;
    let t = if length > 0.0 { (((px - a.0) * dx + (py - a.1) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
    take(n, px, py, a.0 + dx * t, a.1 + dy * t);
}

#[inline]
fn take(n: &mut Nearest, px: f32, py: f32, x: f32, y: f32) {
    let squared = (x - px) * (x - px) + (y - py) * (y - py);
    if squared < n.squared {
        *n = Nearest { x, y, squared };
    }
}

/// Sequential vector propagation: two sweeps over the picture hand every pixel a near neighbour's contour point.
fn propagate(width: usize, height: usize, nearest: &mut [Nearest]) {
    let pass = |nearest: &mut [Nearest], y: usize, x: usize, from: usize| {
        let candidate = nearest[from];
        if candidate.squared.is_finite() {
            take(&mut nearest[y * width + x], x as f32, y as f32, candidate.x, candidate.y);
        }
    };
    for y in 0..height {
        for x in 0..width {
            if y > 0 {
                let up = (y - 1) * width + x;
                pass(nearest, y, x, up);
                if x > 0 {
                    pass(nearest, y, x, up - 1);
                }
                if x + 1 < width {
                    pass(nearest, y, x, up + 1);
                }
            }
            if x > 0 {
                pass(nearest, y, x, y * width + x - 1);
            }
        }
        for x in (0..width - 1).rev() {
            pass(nearest, y, x, y * width + x + 1);
        }
    }
    for y in (0..height).rev() {
        for x in (0..width).rev() {
            if y + 1 < height {
                let down = (y + 1) * width + x;
                pass(nearest, y, x, down);
                if x > 0 {
                    pass(nearest, y, x, down - 1);
                }
                if x + 1 < width {
                    pass(nearest, y, x, down + 1);
                }
            }
            if x + 1 < width {
                pass(nearest, y, x, y * width + x + 1);
            }
        }
        for x in 1..width {
            pass(nearest, y, x, y * width + x - 1);
        }
    }
}
