//! Finds the smallest number of views at fault that explains the uncovered pixels.

use super::excluders::{Excluders, NOBODY, Sets, TOLERATED, size};
use crate::sort::short_by;
use alloc::{vec, vec::Vec};

/// Number of views whose uncovered pixels do not count against another view: those with the most. A matte that shows more
/// than the object has many uncovered pixels, and must not put the blame on a view by itself.
const NOT_COUNTED: usize = 2;

/// An uncovered pixel.
struct Pixel {
    /// The view that it belongs to.
    view: u16,
    /// Number of pixels that it stands for.
    weight: f32,
    /// Views that exclude the places of its ray: one of these sets is at fault.
    sets: Sets,
}

/// The uncovered pixels of all views.
pub(super) struct Blame {
    views: usize,
    pixels: Vec<Pixel>,
}

impl Blame {
    pub(super) fn new(views: usize) -> Self {
        Self { views, pixels: Vec::new() }
    }

    /// Adds a pixel of `view` that stands for `weight` pixels, with the sets of views that exclude the places of its ray.
    pub(super) fn add(&mut self, view: u16, weight: f32, sets: Sets) {
        self.pixels.push(Pixel { view, weight, sets });
    }

    /// The views at fault with the number of pixels that they explain, the worst one first. What it explains is not held
    /// against the others. A view is at fault if it explains at least `limit` pixels. There are at most `most`.
    pub(super) fn at_fault(&self, limit: f32, most: usize) -> Vec<(u16, f32)> {
        let mut found: Vec<(u16, f32)> = Vec::new();
        while found.len() < most {
            let explained = self.explained(|view| found.iter().any(|&(at_fault, _)| at_fault == view));
            // Of equal ones the first.
            let worst = (0..self.views).rev().max_by(|&a, &b| explained[a].total_cmp(&explained[b]));
            match worst {
                Some(worst) if explained[worst] >= limit => found.push((worst as u16, explained[worst])),
                _ => break,
            }
        }
        found
    }

    /// The number of pixels that each view explains, given those that are known to be at fault.
    fn explained(&self, is_at_fault: impl Fn(u16) -> bool) -> Vec<f32> {
        // For each view, by the view that the pixels belong to.
        let mut by_view = vec![0.0f32; self.views * self.views];
        for Pixel { view, weight, sets } in self.pixels.iter().filter(|pixel| !is_at_fault(pixel.view)) {
            let mut left = [NOBODY; Sets::MOST];
            for (left, set) in left.iter_mut().zip(sets.iter()) {
                *left = set.map(|view| if is_at_fault(view) { u16::MAX } else { view });
            }
            let left: &[Excluders] = &left[..sets.iter().len()];
            let smallest = left.iter().map(size).min().unwrap_or(TOLERATED as usize);
            // Explained by a view that is known to be at fault.
            if smallest == 0 {
                continue;
            }
            let plausible = || left.iter().filter(|set| size(set) == smallest);
            let share = weight / (plausible().count() * smallest) as f32;
            for &excluder in plausible().flatten().filter(|&&excluder| excluder != u16::MAX) {
                by_view[usize::from(excluder) * self.views + usize::from(*view)] += share;
            }
        }
        by_view
            .chunks_exact_mut(self.views.max(1))
            .map(|pixels| {
                short_by(pixels, |a, b| b.total_cmp(a));
                pixels.iter().skip(NOT_COUNTED).sum()
            })
            .collect()
    }
}
