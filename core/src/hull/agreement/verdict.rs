//! Finds the smallest number of views at fault that explains what the witnesses say.

use super::excluders::{Excluders, Sets, TOLERATED, size};
use alloc::{vec, vec::Vec};

/// Number of accusing views whose pixels do not count: those with the most. A matte that shows more than the object
/// has many uncovered pixels, and must not accuse anybody alone.
const NOT_COUNTED: usize = 2;

/// What the witnesses have said.
pub(super) struct Verdict {
    views: usize,
    /// The accusing view, the number of pixels that it stands for, and the sets of views of which one is at fault.
    statements: Vec<(u16, f32, Sets)>,
}

impl Verdict {
    pub(super) fn new(views: usize) -> Self {
        Self { views, statements: Vec::new() }
    }

    /// Records what a pixel of the view `from`, which stands for `weight` pixels, says.
    pub(super) fn record(&mut self, from: u16, weight: f32, sets: Sets) {
        self.statements.push((from, weight, sets));
    }

    /// The views at fault, found one after the other: the one against which most is said comes first, and what it
    /// explains is not held against others. A view is at fault if at least `limit` pixels say so. There are at most
    /// `most`.
    pub(super) fn guilty(&self, limit: f32, most: usize) -> Vec<u16> {
        let mut guilty: Vec<u16> = Vec::new();
        while guilty.len() < most {
            let blame = self.blame(&guilty);
            // Of equal ones the first.
            let worst = (0..self.views).rev().max_by(|&a, &b| blame[a].total_cmp(&blame[b]));
            match worst {
                Some(worst) if blame[worst] >= limit => guilty.push(worst as u16),
                _ => break,
            }
        }
        guilty
    }

    /// The number of pixels that speak against each view, given that some are known to be at fault.
    fn blame(&self, guilty: &[u16]) -> Vec<f32> {
        let mut by_accuser = vec![0.0f32; self.views * self.views];
        for (from, weight, sets) in self.statements.iter().filter(|(from, ..)| !guilty.contains(from)) {
            let remaining = |set: &Excluders| -> Excluders {
                let mut set = *set;
                set.iter_mut().filter(|view| guilty.contains(view)).for_each(|view| *view = u16::MAX);
                set
            };
            let sets: Vec<Excluders> = sets.sets[..sets.count].iter().map(remaining).collect();
            let smallest = sets.iter().map(size).min().unwrap_or(TOLERATED as usize);
            // Explained by a view that is known to be at fault.
            if smallest == 0 {
                continue;
            }
            let plausible = || sets.iter().filter(|set| size(set) == smallest);
            let share = weight / (plausible().count() * smallest) as f32;
            for &view in plausible().flatten().filter(|&&view| view != u16::MAX) {
                by_accuser[usize::from(view) * self.views + usize::from(*from)] += share;
            }
        }
        by_accuser
            .chunks_exact_mut(self.views.max(1))
            .map(|accusers| {
                accusers.sort_unstable_by(|a, b| b.total_cmp(a));
                accusers.iter().skip(NOT_COUNTED).sum()
            })
            .collect()
    }
}
