//! Colour histograms of object and background over the whole picture.

use super::patch::Patch;
use crate::silhouette::{refill::refill, stored::UNITS};
use alloc::vec::Vec;

/// Bits of a channel that bins leave out, and bins along each axis.
const SHIFT: u32 = 4;
const BINS: usize = 256 >> SHIFT;
/// Pixels added to every bin of the side with fewer pixels: colours that are rare on both sides are no evidence.
const PRIOR: f32 = 2.0;
/// Pixels nearer to the matte's contour than this are left out, as the matte may be wrong there.
const MARGIN: f32 = 3.0;
/// Limit of a ratio's logarithm.
const MAX_RATIO: f32 = 4.0;

/// Logarithms of likelihood ratios by colour, positive where a colour is more frequent on the object.
#[derive(Debug, Default)]
pub(super) struct Likelihoods {
    /// Pixels of background and object in every bin.
    counts: [Vec<u32>; 2],
    ratios: Vec<f32>,
}

impl Likelihoods {
    /// Counts the colours of both sides of a matte's contour.
    pub fn count(&mut self, patch: &Patch, distance: &[i16]) {
        let margin = (MARGIN * UNITS) as u16;
        let Self { counts, ratios } = self;
        counts.iter_mut().for_each(|side| refill(side, BINS * BINS * BINS, 0));
        for y in 0..patch.height {
            for x in 0..patch.width {
                let d = distance[y * patch.width + x];
                if d.unsigned_abs() > margin {
                    counts[usize::from(d > 0)][bin(patch.bytes(x, y))] += 1;
                }
            }
        }
        let [background, object] = counts;
        let total = |counts: &[u32]| counts.iter().sum::<u32>().max(1) as f32;
        let (b, p) = (total(background), total(object));
        let least = PRIOR / b.min(p);
        let share = |count: u32, total: f32| count as f32 / total + least;
        let ratio = |(&background, &object): (&u32, &u32)| {
            if background == 0 && object == 0 {
                return 0.0;
            }
            libm::logf(share(object, p) / share(background, b)).clamp(-MAX_RATIO, MAX_RATIO)
        };
        ratios.clear();
        ratios.extend(background.iter().zip(&*object).map(ratio));
    }

    /// Logarithm of the likelihood ratio of a pixel's colour.
    #[inline]
    pub fn ratio(&self, rgb: [u8; 3]) -> f32 {
        self.ratios[bin(rgb)]
    }
}

#[inline]
fn bin(rgb: [u8; 3]) -> usize {
    rgb.into_iter().fold(0, |bin, v| bin * BINS + usize::from(v >> SHIFT))
}
