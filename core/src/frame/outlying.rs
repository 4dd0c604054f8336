//! Views whose silhouettes lie beside the outline of the hull of all.
//!
//! A camera that was moved by a pixel or two since it was calibrated makes the others lack so little that it is not at fault
//! by [`crate::hull::contradicting`]. But its own contour then lies several times farther from the hull's outline than those
//! of the others, and its points of stereo lie beside those of the others.

use super::state::Frame;
use crate::{
    math::{max, median, ordered},
    rig::Rig,
};
use alloc::vec::Vec;
use core::ops::Deref;

/// How a view's silhouette fits the hull of all.
pub(super) struct Fit {
    /// The camera as it was given, and its place in the rig's order.
    pub camera: u32,
    pub place: u16,
    /// Intersection over union.
    pub overlap: f32,
    /// Mean distance of contour and hull's outline in pixels.
    pub apart: f32,
}

/// A silhouette disagrees with the others if its contour and the hull's outline are farther apart than this multiple of the
/// median of all views, and than this number of pixels. Clean captures and rough ones stay below two medians, one with
/// inaccurate masks below three. A camera that was moved by 1.3 pixels is at five.
const MEDIANS: f32 = 3.0;
const PIXELS: f32 = 0.2;
/// Cameras that may have been moved: one, or at most this share and this number. One that was moved makes the one on the other
/// side outlying, too, so that twice as many may be outlying at first. If more are, it is not clear who is right.
const LARGEST_SHARE: f32 = 0.1;
const MOST: usize = 2;
/// Number of silhouettes that must remain. With fewer, each view that is missing costs more than one that is a little off.
const FEWEST: usize = 8;

/// If half of the contours lie more than this from the hull's outline, in pixels, the silhouettes are not accurate enough to tell
/// that a single camera was moved.
const INACCURATE: f32 = 0.5;

/// The distance in pixels of contours from the hull's outline, the median of all views.
fn typical(fits: &[Fit]) -> f32 {
    median(fits.iter().map(|fit| fit.apart)).unwrap_or(0.0)
}

/// Whether a silhouette disagrees with the others.
pub(super) fn is_outlying(fits: &[Fit]) -> impl Fn(&Fit) -> bool {
    let limit = max(MEDIANS * typical(fits), PIXELS);
    move |fit| fit.apart > limit
}

impl<R: Deref<Target = Rig>> Frame<R> {
    /// The fits of the silhouettes that carve the hull, in the order in which the cameras were given.
    pub(super) fn fits(&self) -> Vec<Fit> {
        let fit = |camera: u32| {
            let place = self.rig().place(camera as usize)?;
            let view = self.views().get(place).filter(|view| view.is_used() && !view.is_set_aside());
            let found = view.and(self.compared.get(place))?;
            Some(Fit { camera, place: place as u16, overlap: found.overlap?, apart: found.apart? })
        };
        (0..self.cameras() as u32).filter_map(fit).collect()
    }

    /// How many views may be left out because their cameras were moved a little.
    pub(super) fn most_moved(&self) -> usize {
        let silhouettes = self.fits().len();
        let most = (max(LARGEST_SHARE * silhouettes as f32, 1.0) as usize).min(MOST);
        most.min(silhouettes.saturating_sub(FEWEST))
    }

    /// Place in the rig's order of the view that is most outlying because its camera was moved, if it is clear. `most` views at
    /// most were moved.
    pub(super) fn moved(&self, most: usize) -> Option<u16> {
        let fits = self.fits();
        let is_outlying = is_outlying(&fits);
        let outlying = || fits.iter().filter(|&fit| is_outlying(fit));
        let worst = outlying().max_by_key(|fit| ordered(fit.apart))?;
        let follows = self.views()[usize::from(worst.place)].edge.is_some_and(|edge| edge.is_followed());
        let is_clear = typical(&fits) < INACCURATE && outlying().count() <= 2 * most;
        (follows && is_clear).then_some(worst.place)
    }
}
