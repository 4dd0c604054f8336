//! Labels that agree with the evidence and with their neighbours (Besag, On the Statistical Analysis of Dirty Pictures,
//! 1986).

use alloc::vec::Vec;

/// Evidence that equals one neighbour with the other label.
const PER_NEIGHBOUR: f32 = 0.5;
/// Evidence from which on the eight neighbours together cannot overrule a pixel.
pub(super) const DECISIVE: f32 = 8.0 * PER_NEIGHBOUR;
const ROUNDS: usize = 8;

/// Labels pixels by the sign of their evidence, then repeatedly by the evidence and the labels of the eight neighbours.
/// Pixels at the picture's edge keep the sign of their evidence.
pub(super) fn label(w: usize, h: usize, evidence: &[f32]) -> Vec<bool> {
    let mut labels: Vec<bool> = evidence.iter().map(|&e| e > 0.0).collect();
    let open: Vec<u32> = (0..w * h)
        .filter(|&i| evidence[i].abs() < DECISIVE)
        .filter(|&i| i % w > 0 && i % w + 1 < w && i / w > 0 && i / w + 1 < h)
        .map(|i| i as u32)
        .collect();
    let mut next = labels.clone();
    for _ in 0..ROUNDS {
        for &i in &open {
            let i = i as usize;
            let around = [i - w - 1, i - w, i - w + 1, i - 1, i + 1, i + w - 1, i + w, i + w + 1];
            let object = around.into_iter().filter(|&j| labels[j]).count() as f32;
            next[i] = evidence[i] + PER_NEIGHBOUR * (2.0 * object - 8.0) > 0.0;
        }
        open.iter().for_each(|&i| labels[i as usize] = next[i as usize]);
    }
    labels
}
