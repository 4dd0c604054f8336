//! A painted backdrop: one colour, unevenly lit.

use super::{backdrop::Backdrop, likeness::Likeness};
use crate::silhouette::colour::{angle, from_gray, vector, within};
use glam::Vec3;

/// Pixels nearer to the initial colour than this share of its distance from grey are the first estimate.
const INITIAL: f32 = 0.6;
/// A pixel is paint if it differs from the paint nearby by at most this many times what this quantile of the paint does. The
/// quantile is that of one standard deviation, in two dimensions about the median.
const PAINT_TIMES: f32 = 3.0;
const PAINT_QUANTILE: f32 = 0.7;
/// Smallest limit of paint, as a share of the tolerated angle.
const PAINT_LEAST: f32 = 0.2;
/// Steps of the tolerated angle in which deviations are counted.
const STEPS: usize = 256;

/// A backdrop's local colours, and how much colours may differ from them.
pub(in crate::silhouette) struct Paint {
    backdrop: Backdrop,
    /// Cosine of the tolerated angle.
    cosine: f32,
    /// Angle in radians within which pixels certainly are paint.
    certain: f32,
    darkest_shadow: f32,
}

impl Paint {
    /// Finds the paint in a picture of packed sRGB. `hint` is its approximate colour; `tolerance` the tolerated angle as a
    /// share of the angle between the paint and grey. `None` if no pixel is close to the hint.
    pub fn find(w: usize, h: usize, rgb: &[u8], hint: Vec3, tolerance: f32, darkest_shadow: f32) -> Option<Self> {
        let global = mean(rgb, hint, from_gray(hint) * INITIAL)?;
        let limit = from_gray(global) * tolerance;
        let backdrop = Backdrop::estimate(w, h, rgb, global, limit);
        let mut paint = Self { backdrop, certain: limit, cosine: libm::cosf(limit), darkest_shadow };
        let mut counts = [0u32; STEPS];
        for i in 0..w * h {
            if let Some(deviation) = paint.deviation(w, rgb, i) {
                counts[((deviation / limit * STEPS as f32) as usize).min(STEPS - 1)] += 1;
            }
        }
        let wanted = (PAINT_QUANTILE * counts.iter().sum::<u32>() as f32) as u32;
        let mut below = 0;
        let quantile = counts.iter().position(|count| {
            below += count;
            below >= wanted
        });
        let share = (quantile.unwrap_or(STEPS) + 1) as f32 / STEPS as f32;
        paint.certain = limit * (PAINT_TIMES * share).clamp(PAINT_LEAST, 1.0);
        Some(paint)
    }

    /// How a pixel compares with the paint.
    pub fn likeness(&self, w: usize, rgb: &[u8], i: usize) -> Likeness {
        match self.deviation(w, rgb, i) {
            None => Likeness::Other,
            Some(deviation) if deviation <= self.certain => Likeness::Paint,
            Some(_) => Likeness::Similar,
        }
    }

    /// Angle between a pixel's colour and the local paint's, if it is tolerated and the pixel is not darker than a shadow.
    fn deviation(&self, w: usize, rgb: &[u8], i: usize) -> Option<f32> {
        let (colour, local) = (vector(&rgb[3 * i..]), self.backdrop.at(i % w, i / w));
        let (along, brightness) = (colour.dot(local), local.length_squared());
        if along < self.darkest_shadow * brightness || !within(colour, local, self.cosine) {
            return None;
        }
        Some(angle(colour, local))
    }
}

/// Mean of the colours whose angle to a centre is less than `limit` radians.
fn mean(rgb: &[u8], centre: Vec3, limit: f32) -> Option<Vec3> {
    let cosine = libm::cosf(limit);
    let (mut sums, mut count) = ([0u64; 3], 0u64);
    for pixel in rgb.chunks_exact(3).filter(|p| within(vector(p), centre, cosine)) {
        (0..3).for_each(|c| sums[c] += u64::from(pixel[c]));
        count += 1;
    }
    (count > 0).then(|| Vec3::from_array(sums.map(|s| s as f32 / count as f32)))
}
