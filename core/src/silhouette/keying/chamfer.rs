//! Distances to a set of pixels.

use alloc::vec::Vec;

/// Length of a step to the side. A diagonal step is 4/3 as long (Borgefors, Distance Transformations in Digital Images,
/// 1986), so that distances are Euclidean to about 6 %.
pub(super) const STEP: u32 = 3;
const DIAGONAL: u32 = 4;

/// Distance of every pixel to the nearest one of a set, in thirds of a pixel. `u32::MAX / 2` if the set is empty.
pub(super) fn distances(w: usize, h: usize, is_in: &dyn Fn(usize) -> bool) -> Vec<u32> {
    let far = u32::MAX / 2;
    let mut d: Vec<u32> = (0..w * h).map(|i| if is_in(i) { 0 } else { far }).collect();
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            let mut least = d[i];
            if x > 0 {
                least = least.min(d[i - 1] + STEP);
            }
            if y > 0 {
                least = least.min(d[i - w] + STEP);
                if x > 0 {
                    least = least.min(d[i - w - 1] + DIAGONAL);
                }
                if x + 1 < w {
                    least = least.min(d[i - w + 1] + DIAGONAL);
                }
            }
            d[i] = least;
        }
    }
    for y in (0..h).rev() {
        for x in (0..w).rev() {
            let i = y * w + x;
            let mut least = d[i];
            if x + 1 < w {
                least = least.min(d[i + 1] + STEP);
            }
            if y + 1 < h {
                least = least.min(d[i + w] + STEP);
                if x > 0 {
                    least = least.min(d[i + w - 1] + DIAGONAL);
                }
                if x + 1 < w {
                    least = least.min(d[i + w + 1] + DIAGONAL);
                }
            }
            d[i] = least;
        }
    }
    d
}
