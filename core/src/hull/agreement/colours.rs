//! Colours of the object as all views show it, against those of a view's own background.

use crate::{executor::Executor, silhouette::Silhouette, view::View};
use alloc::{vec, vec::Vec};

/// Bits of a channel that bins leave out, and bins along each axis.
const SHIFT: u32 = 4;
const BINS: usize = 256 >> SHIFT;
/// Pixels nearer to the contour than this are not counted as object.
const INSIDE: f32 = 3.0;
/// Pixels nearer to the contour than this are not counted as background: parts that a matte lacks are mostly thinner.
const OUTSIDE: f32 = -12.0;
/// Pixels that are added to every bin, so that colours that are rare on both sides are no evidence.
const PRIOR: f32 = 20.0;

/// Number of pixels of every colour.
struct Histogram {
    counts: Vec<u32>,
    total: u32,
}

impl Histogram {
    fn new() -> Self {
        Self { counts: vec![0; BINS * BINS * BINS], total: 0 }
    }

    /// Counts every second pixel of every second row whose distance is accepted.
    fn count(&mut self, view: &View, silhouette: &Silhouette, accepts: impl Fn(i16) -> bool) {
        let w = silhouette.width as usize;
        for (y, row) in silhouette.distances().chunks_exact(w).enumerate().step_by(2) {
            for (x, _) in row.iter().enumerate().step_by(2).filter(|&(_, &d)| d != Silhouette::UNKNOWN && accepts(d)) {
                self.counts[bin(&view.rgb[(y * w + x) * 3..])] += 1;
                self.total += 1;
            }
        }
    }
}

/// Colours of the object in all views.
pub(super) struct ObjectColours(Histogram);

impl ObjectColours {
    /// Counts them.
    pub(super) fn new(views: &[View], executor: &dyn Executor) -> Self {
        let inside = (INSIDE * Silhouette::UNITS) as i16;
        let counted = executor.map(views.len(), |i| {
            let mut histogram = Histogram::new();
            if let Some(silhouette) = views[i].silhouette.as_ref().filter(|_| views[i].is_used()) {
                histogram.count(&views[i], silhouette, |d| d > inside);
            }
            histogram
        });
        let mut all = Histogram::new();
        for Histogram { counts, total } in counted {
            all.counts.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
            all.total += total;
        }
        Self(all)
    }

    /// For every colour, how many times more frequent it is on the object than in a view's background.
    pub(super) fn against_background(&self, view: &View, silhouette: &Silhouette) -> Vec<f32> {
        let outside = (OUTSIDE * Silhouette::UNITS) as i16;
        let mut background = Histogram::new();
        background.count(view, silhouette, |d| d < outside);
        let (object, background) = (&self.0, &background);
        let total = |histogram: &Histogram| histogram.total.max(1) as f32;
        let prior = PRIOR / total(object).min(total(background));
        let share = |count: u32, total: f32| count as f32 / total + prior;
        let ratio = |(&o, &b): (&u32, &u32)| share(o, total(object)) / share(b, total(background));
        object.counts.iter().zip(&background.counts).map(ratio).collect()
    }
}

/// The bin of a colour, of which `rgb` starts with the three channels.
#[inline]
pub(super) fn bin(rgb: &[u8]) -> usize {
    rgb[..3].iter().fold(0, |bin, v| bin * BINS + usize::from(v >> SHIFT))
}
