//! The resolution at which pictures are read.

use crate::image;
use alloc::{vec, vec::Vec};

/// The resolution at which pictures are read. All lengths in pixels are those of the pictures as they are read.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ReadingParams {
    /// Level of the image pyramid: 0 is full resolution and 1 half of it.
    pub octave: u32,
    /// Pictures in which the object is large are read at half the resolution where they are blurred: if the energy of the
    /// luma's second differences is less than this share of that at the next octave, and there less than this share of that
    /// at the octave after it. `None` reads all of them at the same octave.
    pub blurred: Option<f32>,
}

impl ReadingParams {
    /// Every picture as it is.
    pub const FULL: Self = Self { octave: 0, blurred: None };
}

/// Pictures are not read with fewer columns or rows than this, unless they have fewer themselves.
const SMALLEST: usize = 120;
/// A blurred picture is halved only if the object covers at least this many pixels afterwards.
const ENOUGH: u64 = 150_000;
/// A second difference counts only where the pixels at this distance, along both axes and in both directions, show the object.
const INNER: usize = 3;

/// A picture and its mask at one resolution, packed: sRGB, and one byte per pixel, 255 on the object.
pub(crate) struct Reduced<'a> {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) rgb: &'a mut Vec<u8>,
    /// Empty without a mask.
    pub(crate) mask: &'a mut Vec<u8>,
    /// Which pixels have a source. Empty if all have.
    pub(crate) known: &'a mut Vec<bool>,
}

impl Reduced<'_> {
    /// Brings the picture to the octave at which it is to be read, and returns that octave.
    pub(crate) fn reduce(&mut self, params: &ReadingParams) -> u32 {
        let mut octave = 0;
        while self.width.min(self.height) / 2 >= SMALLEST && (octave < params.octave || self.is_blurred(params.blurred))
        {
            self.halve();
            octave += 1;
        }
        octave
    }

    /// Halves the picture by averaging 2 x 2 pixels. The memory of the larger one is freed.
    fn halve(&mut self) {
        let (w, h) = (self.width, self.height);
        halve::<3>(w, h, self.rgb);
        if !self.mask.is_empty() {
            halve::<1>(w, h, self.mask);
        }
        (self.width, self.height) = (w / 2, h / 2);
        if !self.known.is_empty() {
            for y in 0..h / 2 {
                for x in 0..w / 2 {
                    let i = 2 * y * w + 2 * x;
                    self.known[y * (w / 2) + x] = [i, i + 1, i + w, i + w + 1].into_iter().all(|i| self.known[i]);
                }
            }
            self.known.truncate(self.width * self.height);
        }
    }

    /// Whether the picture has a large object and no detail at its two finest octaves.
    fn is_blurred(&self, share: Option<f32>) -> bool {
        let Some(share) = share.filter(|_| !self.mask.is_empty()) else { return false };
        let pixels = self.mask.iter().filter(|&&covered| covered > 127).count() as u64;
        if pixels / 4 < ENOUGH {
            return false;
        }
        let mut luma: Vec<u8> = self.rgb.chunks_exact(3).map(|p| image::luma([p[0], p[1], p[2]])).collect();
        let mut mask = self.mask.clone();
        let (mut w, mut h) = (self.width, self.height);
        let mut finer = energy(w, h, &luma, &mask);
        (0..2).all(|_| {
            halve::<1>(w, h, &mut luma);
            halve::<1>(w, h, &mut mask);
            (w, h) = (w / 2, h / 2);
            let coarser = energy(w, h, &luma, &mask);
            let blurred = finer < f64::from(share) * coarser;
            finer = coarser;
            blurred
        })
    }
}

/// Mean square of the second differences of the luma along both axes, inside the object.
fn energy(w: usize, h: usize, luma: &[u8], mask: &[u8]) -> f64 {
    let (mut sum, mut count) = (0u64, 0u64);
    for y in INNER..h.saturating_sub(INNER) {
        for x in INNER..w.saturating_sub(INNER) {
            let i = y * w + x;
            if [i, i - INNER, i + INNER, i - INNER * w, i + INNER * w].into_iter().any(|i| mask[i] <= 127) {
                continue;
            }
            let at = |i: usize| i32::from(luma[i]);
            let (across, down) = (at(i - 1) - 2 * at(i) + at(i + 1), at(i - w) - 2 * at(i) + at(i + w));
            sum += (across * across + down * down) as u64;
            count += 2;
        }
    }
    if count > 0 { sum as f64 / count as f64 } else { 0.0 }
}

/// Averages squares of 2 x 2 pixels of packed bytes, in place: what is written lies before what is still to be read.
fn halve<const CHANNELS: usize>(w: usize, h: usize, bytes: &mut Vec<u8>) {
    let row = w * CHANNELS;
    let mut sums = vec![0u16; row];
    let mut out = 0;
    for y in 0..h / 2 {
        let (upper, lower) = bytes[2 * y * row..][..2 * row].split_at(row);
        for (sum, (&a, &b)) in sums.iter_mut().zip(upper.iter().zip(lower)) {
            *sum = u16::from(a) + u16::from(b);
        }
        let means = &mut bytes[out..out + w / 2 * CHANNELS];
        for (means, pair) in means.chunks_exact_mut(CHANNELS).zip(sums.chunks_exact(2 * CHANNELS)) {
            for channel in 0..CHANNELS {
                means[channel] = ((pair[channel] + pair[channel + CHANNELS] + 2) / 4) as u8;
            }
        }
        out += w / 2 * CHANNELS;
    }
    bytes.truncate(out);
    bytes.shrink_to_fit();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of stripes with the given period in pixels, and a mask that leaves out its border.
    fn stripes(side: usize, period: f32) -> [Vec<u8>; 2] {
        let wave = |v: usize| libm::sinf(v as f32 * core::f32::consts::TAU / period);
        let level = |i: usize| (128.0 + 60.0 * wave(i % side) * wave(i / side)) as u8;
        let inner = |v: usize| (8..side - 8).contains(&v);
        let rgb = (0..side * side).flat_map(|i| [level(i); 3]).collect();
        [rgb, (0..side * side).map(|i| if inner(i % side) && inner(i / side) { 255 } else { 0 }).collect()]
    }

    fn octave(side: usize, period: f32, params: &ReadingParams) -> u32 {
        let [mut rgb, mut mask] = stripes(side, period);
        let mut known = Vec::new();
        let mut picture = Reduced { width: side, height: side, rgb: &mut rgb, mask: &mut mask, known: &mut known };
        let octave = picture.reduce(params);
        let side = side >> octave;
        assert_eq!((picture.width, picture.height, rgb.len(), mask.len()), (side, side, 3 * side * side, side * side));
        octave
    }

    #[test]
    fn large_pictures_without_detail_are_halved_and_others_are_not() {
        let params = ReadingParams { octave: 0, blurred: Some(0.25) };
        // The largest object that may be halved twice, and one that may not be halved at all.
        assert_eq!(octave(1700, 24.0, &params), 2);
        assert_eq!(octave(700, 24.0, &params), 0);
        // Detail at the finest octave, or at the next one.
        assert_eq!(octave(1700, 3.0, &params), 0);
        assert_eq!(octave(1700, 6.0, &params), 0);
        assert_eq!(octave(1700, 24.0, &ReadingParams::FULL), 0);
        assert_eq!(octave(500, 3.0, &ReadingParams { octave: 3, blurred: None }), 2, "125 pixels are left");
        assert_eq!(octave(200, 3.0, &ReadingParams { octave: 1, blurred: None }), 0);
    }

    #[test]
    fn halving_averages_and_keeps_only_known_pixels() {
        let mut rgb = (0..5 * 4 * 3).map(|i| 4 * i as u8).collect::<Vec<u8>>();
        let (mut mask, mut known) = (vec![0; 20], vec![true; 20]);
        mask[..2].fill(255);
        known[7] = false;
        let mut picture = Reduced { width: 5, height: 4, rgb: &mut rgb, mask: &mut mask, known: &mut known };
        picture.halve();
        assert_eq!((picture.width, picture.height), (2, 2));
        // Pixels 0, 1, 5 and 6 of the first square; the last column has no partner.
        assert_eq!(rgb[..3], [36, 40, 44]);
        assert_eq!(mask, [128, 0, 0, 0]);
        assert_eq!(known, [true, false, true, true]);
    }
}
