//! How far the picture has moved a matte's contour.

use super::{profile::Profiles, trace::Loops};

/// Contours that moved by more than this have moved far, in pixels. Mattes that are made well are more exact.
const FAR: f32 = 2.0;
/// Number of bins of the histogram per pixel of distance.
const BINS: f32 = 4.0;
/// Range of the histogram on either side of 0, in pixels. Larger distances count in its outermost bins.
const REACH: f32 = 32.0;
/// Number of bins of the histogram.
const COUNT: usize = 2 * (REACH * BINS) as usize + 1;

/// How far the picture has moved a matte's contour, in pixels of the picture as it was read.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Moved {
    /// The median over the contour, to a quarter of a pixel, positive inwards.
    pub median: f32,
    /// Shares of the contour that moved far: inwards, and outwards.
    pub far: [f32; 2],
}

impl Moved {
    /// From the moved loops and the signed distance to the matte's contour.
    pub(super) fn new(loops: &Loops, profiles: &Profiles, given: &[i16]) -> Self {
        // A histogram instead of a sorted list, because views are read without allocations.
        let (mut bins, mut all, mut far) = ([0u32; COUNT], 0u32, [0u32; 2]);
        for distance in loops.points.iter().filter_map(|&p| profiles.interpolate(given, p)) {
            let bin = (distance.clamp(-REACH, REACH) + REACH) * BINS + 0.5;
            bins[bin as usize] += 1;
            all += 1;
            far[0] += u32::from(distance > FAR);
            far[1] += u32::from(distance < -FAR);
        }
        let mut below = 0;
        let middle = bins.iter().position(|&count| {
            below += count;
            2 * below > all
        });
        let share = |count: u32| count as f32 / all.max(1) as f32;
        Self { median: middle.map_or(0.0, |bin| bin as f32 / BINS - REACH), far: far.map(share) }
    }
}
