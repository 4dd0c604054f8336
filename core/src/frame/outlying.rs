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

/// How far a contour may lie from the hull's outline: a multiple of the median of all views, and a number of pixels, whichever
/// is more.
pub(super) struct Allowed {
    medians: f32,
    pixels: f32,
}

/// A silhouette disagrees with the others beyond this. It is named.
pub(super) const NAMED: Allowed = Allowed { medians: 3.0, pixels: 0.3 };
/// A camera has been moved beyond this, if its silhouette follows its picture. Clean captures stay below 2 medians, rough ones
/// too, and one with inaccurate masks below 3. A camera that was moved by 1.3 pixels is at 5.
const MOVED: Allowed = Allowed { medians: 4.0, pixels: 0.2 };
/// So many views may be left out: one, or at most this share. A camera that was moved makes the one on the other side outlying,
/// too, so that twice as many may be outlying at first. If more are, it is not clear who is right.
const LARGEST_SHARE: f32 = 0.1;
/// Number of silhouettes that must remain. With fewer, each view that is missing costs more than one that is a little off.
const FEWEST: usize = 8;

/// The limit in pixels.
pub(super) fn limit(fits: &[Fit], allowed: Allowed) -> f32 {
    let typical = median(fits.iter().map(|fit| fit.apart)).unwrap_or(0.0);
    max(allowed.medians * typical, allowed.pixels)
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
        let most = max(LARGEST_SHARE * silhouettes as f32, 1.0) as usize;
        most.min(silhouettes.saturating_sub(FEWEST))
    }

    /// Place in the rig's order of the view that is most outlying because its camera was moved, if it is clear. `most` views at
    /// most were moved.
    pub(super) fn moved(&self, most: usize) -> Option<u16> {
        let fits = self.fits();
        let limit = limit(&fits, MOVED);
        let outlying = || fits.iter().filter(|fit| fit.apart > limit);
        let worst = outlying().max_by_key(|fit| ordered(fit.apart))?;
        let follows = self.views()[usize::from(worst.place)].edge.is_some_and(|edge| edge.is_followed());
        (follows && outlying().count() <= 2 * most).then_some(worst.place)
    }
}
