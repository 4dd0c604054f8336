//! How frequent colours are among some pixels, to tell which of two sides a pixel belongs to.

use alloc::{vec, vec::Vec};

/// Bits of a channel that bins leave out, and bins along each axis.
const SHIFT: u32 = 4;
const BINS: usize = 256 >> SHIFT;

/// Number of pixels of every colour.
pub(crate) struct ColourCounts {
    counts: Vec<u32>,
    total: u32,
}

impl ColourCounts {
    pub(crate) fn new() -> Self {
        Self { counts: vec![0; BINS * BINS * BINS], total: 0 }
    }

    /// Number of pixels.
    pub(crate) fn total(&self) -> u32 {
        self.total
    }

    /// Counts a pixel, of which `rgb` starts with the three channels.
    #[inline]
    pub(crate) fn add(&mut self, rgb: &[u8]) {
        self.counts[bin(rgb)] += 1;
        self.total += 1;
    }

    /// Adds the pixels of other counts.
    pub(crate) fn add_all(&mut self, other: &Self) {
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
        self.total += other.total;
    }

    /// For the bin of every colour, how many times more frequent it is here than among other pixels. `prior` is a share of the
    /// pixels that is added to every bin on both sides, so that colours that are rare on both are no evidence.
    pub(crate) fn against(&self, other: &Self, prior: f32) -> Vec<f32> {
        let [own_total, other_total] = [self, other].map(|counts| counts.total.max(1) as f32);
        let share = |count: u32, total: f32| count as f32 / total + prior;
        let ratio = |(&own, &other): (&u32, &u32)| share(own, own_total) / share(other, other_total);
        self.counts.iter().zip(&other.counts).map(ratio).collect()
    }
}

/// The bin of a colour, of which `rgb` starts with the three channels.
#[inline]
pub(crate) fn bin(rgb: &[u8]) -> usize {
    rgb[..3].iter().fold(0, |bin, v| bin * BINS + usize::from(v >> SHIFT))
}
