//! Converts hard labels to soft coverage. Chroma keying and background subtraction share this step.

use super::{
    colour::vector,
    parts::{Connected, Parts},
};
use crate::chessboard;
use alloc::{vec, vec::Vec};
use glam::Vec3;

/// Pixels at most this far from the border between the labels may be mixtures of object and background.
const BAND: u8 = 3;
/// Half size of the window in which pure colours are sampled for a mixed pixel.
const WINDOW: usize = 5;

/// Inverts the label of connected parts with fewer than `smallest` pixels. With `label` true these are specks of the
/// object (8-connected), otherwise holes in it (4-connected, so that diagonal gaps do not join them).
pub(super) fn remove_small(width: usize, height: usize, object: &mut [bool], label: bool, smallest: usize) {
    let connected = if label { Connected::Corners } else { Connected::Sides };
    let parts = Parts::of_side(width, height, object, label, connected);
    for (i, object) in object.iter_mut().enumerate() {
        if parts.size(i).is_some_and(|pixels| (pixels as usize) < smallest) {
            *object = !label;
        }
    }
}

/// Coverage from labels, by local matting.
///
/// Near the border between the labels a pixel is a mixture α F + (1 - α) B of the nearby colours of object and
/// background. This α locates the contour to a fraction of a pixel, even if the labels are biased. It also works in
/// shadows, because B is local.
pub(super) fn soften(width: usize, height: usize, rgb: &[u8], object: &[bool]) -> Vec<u8> {
    let depth = depths(width, height, object);
    let depth = |x: usize, y: usize| depth[(y + 1) * (width + 2) + x + 1];
    let coverage = |i: usize| {
        let label = if object[i] { 255 } else { 0 };
        let (x, y) = (i % width, i / width);
        if depth(x, y) > BAND {
            return label;
        }
        // Sums of colours and weights of background and object. Pixels far from the border are pure and weigh most.
        let mut sums = [(Vec3::ZERO, 0.0f32); 2];
        for ny in y.saturating_sub(WINDOW)..(y + WINDOW + 1).min(height) {
            for nx in x.saturating_sub(WINDOW)..(x + WINDOW + 1).min(width) {
                let j = ny * width + nx;
                let purity = [0.0, 1.0, 32.0, 1024.0, 1024.0][depth(nx, ny) as usize];
                let (sum, weight) = &mut sums[usize::from(object[j])];
                *sum += vector(&rgb[3 * j..]) * purity;
                *weight += purity;
            }
        }
        let [(b, wb), (f, wf)] = sums;
        if wb == 0.0 || wf == 0.0 {
            return label;
        }
        let (b, f) = (b / wb, f / wf);
        let contrast = (f - b).length_squared();
        // If the two colours differ by no more than noise, α is meaningless.
        if contrast < 100.0 {
            return label;
        }
        let alpha = (vector(&rgb[3 * i..]) - b).dot(f - b) / contrast;
        libm::roundf(alpha.clamp(0.0, 1.0) * 255.0) as u8
    };
    (0..width * height).map(coverage).collect()
}

/// Chessboard distance of every pixel to the nearest pixel with the other label, at most [`BAND`] + 1, in a grid with a
/// margin of one pixel.
fn depths(width: usize, height: usize, object: &[bool]) -> Vec<u8> {
    let padded = width + 2;
    let mut depth = vec![BAND + 1; padded * (height + 2)];
    for y in 0..height {
        for x in 0..width {
            let own = object[y * width + x];
            let mut around = (y.saturating_sub(1)..(y + 2).min(height))
                .flat_map(|ny| (x.saturating_sub(1)..(x + 2).min(width)).map(move |nx| ny * width + nx));
            if around.any(|j| object[j] != own) {
                depth[(y + 1) * padded + x + 1] = 1;
            }
        }
    }
    chessboard::spread(padded, height + 2, &mut depth);
    depth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_distances_to_the_other_label() {
        const W: usize = 31;
        const H: usize = 23;
        let mut state = 7u32;
        for sparsity in [2, 9, 60, 500] {
            let object: Vec<bool> = (0..W * H)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state >> 8).is_multiple_of(sparsity)
                })
                .collect();
            let depth = depths(W, H, &object);
            for i in 0..W * H {
                let (x, y) = (i % W, i / W);
                let others = (0..W * H).filter(|&j| object[j] != object[i]);
                let nearest = others.map(|j| (j % W).abs_diff(x).max((j / W).abs_diff(y))).min().unwrap_or(W);
                let expected = nearest.min(usize::from(BAND) + 1);
                assert_eq!(usize::from(depth[(y + 1) * (W + 2) + x + 1]), expected, "one in {sparsity}: ({x}, {y})");
            }
        }
    }
}
