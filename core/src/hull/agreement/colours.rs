//! Colours of the object as all views show it, against those of a view's own background.

use crate::{colour_counts::ColourCounts, executor::Executor, silhouette::Silhouette, view::View};
use alloc::vec::Vec;

/// Pixels nearer to the contour than this are not counted as object.
const INSIDE: f32 = 3.0;
/// Pixels nearer to the contour than this are not counted as background: parts that a matte lacks are mostly thinner.
const OUTSIDE: f32 = -12.0;
/// Pixels that are added to every bin, so that colours that are rare on both sides are no evidence.
const PRIOR: f32 = 20.0;

/// Counts every second pixel of every second row whose distance is accepted.
fn count(view: &View, silhouette: &Silhouette, accepts: impl Fn(i16) -> bool) -> ColourCounts {
    let mut counts = ColourCounts::new();
    let w = silhouette.width as usize;
    for (y, row) in silhouette.distances().chunks_exact(w).enumerate().step_by(2) {
        for (x, _) in row.iter().enumerate().step_by(2).filter(|&(_, &d)| d != Silhouette::UNKNOWN && accepts(d)) {
            counts.add(&view.rgb[(y * w + x) * 3..]);
        }
    }
    counts
}

/// Colours of the object in all views.
pub(super) struct ObjectColours(ColourCounts);

impl ObjectColours {
    /// Counts them.
    pub(super) fn new(views: &[View], executor: &dyn Executor) -> Self {
        let inside = (INSIDE * Silhouette::UNITS) as i16;
        let counted = executor.map(views.len(), |i| {
            let silhouette = views[i].silhouette.as_ref().filter(|_| views[i].is_used())?;
            Some(count(&views[i], silhouette, |d| d > inside))
        });
        let mut all = ColourCounts::new();
        counted.iter().flatten().for_each(|counts| all.add_all(counts));
        Self(all)
    }

    /// For every colour, how many times more frequent it is on the object than in a view's background.
    pub(super) fn against_background(&self, view: &View, silhouette: &Silhouette) -> Vec<f32> {
        let outside = (OUTSIDE * Silhouette::UNITS) as i16;
        let background = count(view, silhouette, |d| d < outside);
        let fewer = self.0.total().min(background.total()).max(1);
        self.0.against(&background, PRIOR / fewer as f32)
    }
}
