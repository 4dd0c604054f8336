//! Connected parts of a set of pixels.

use alloc::{vec, vec::Vec};

/// The 4-connected parts of the pixels with one label, in the order of their first pixels.
pub(super) struct Parts {
    /// Each pixel's part.
    of: Vec<u32>,
    /// Number of pixels of each part.
    pub sizes: Vec<u32>,
}

impl Parts {
    const NONE: u32 = u32::MAX;

    /// Finds the parts of the pixels whose label is `label`.
    pub fn new(w: usize, h: usize, labels: &[bool], label: bool) -> Self {
        let (mut of, mut sizes) = (vec![Self::NONE; w * h], Vec::new());
        let mut open: Vec<u32> = Vec::new();
        for start in 0..w * h {
            if labels[start] != label || of[start] != Self::NONE {
                continue;
            }
            let part = sizes.len() as u32;
            let mut size = 0;
            of[start] = part;
            open.push(start as u32);
            while let Some(i) = open.pop() {
                let i = i as usize;
                size += 1;
                let (x, y) = (i % w, i / w);
                let near =
                    [(x > 0, i.wrapping_sub(1)), (x + 1 < w, i + 1), (y > 0, i.wrapping_sub(w)), (y + 1 < h, i + w)];
                for (within, j) in near {
                    if within && labels[j] == label && of[j] == Self::NONE {
                        of[j] = part;
                        open.push(j as u32);
                    }
                }
            }
            sizes.push(size);
        }
        Self { of, sizes }
    }

    /// A pixel's part.
    pub fn of(&self, i: usize) -> Option<usize> {
        (self.of[i] != Self::NONE).then_some(self.of[i] as usize)
    }
}

/// Removes the parts with fewer pixels than a share of those of the largest one.
pub(super) fn keep_large(w: usize, h: usize, labels: &mut [bool], share: f32) {
    let parts = Parts::new(w, h, labels, true);
    let largest = parts.sizes.iter().copied().max().unwrap_or(0);
    for (i, label) in labels.iter_mut().enumerate() {
        *label = parts.of(i).is_some_and(|part| parts.sizes[part] as f32 >= share * largest as f32);
    }
}
