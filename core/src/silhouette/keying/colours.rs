//! Colours as logarithms, in bins.

use alloc::{vec, vec::Vec};

/// Bins of light, and of each of the two differences between channels.
pub(super) const LIGHT: usize = 48;
pub(super) const HUE: usize = 64;
/// Logarithms of light that the bins span. The differences span ±[`WIDEST`].
const DARKEST: f32 = 2.3;
const BRIGHTEST: f32 = 5.6;
const WIDEST: f32 = 1.6;
/// Levels added before the logarithm, so that noise counts equally in dark and in bright colours.
const DARK_LEVELS: f32 = 10.0;
/// Weights of a window with a standard deviation of 1.4 pixels, by which the picture's noise is smoothed.
const WINDOW: [u32; 9] = [1, 8, 28, 56, 70, 56, 28, 8, 1];
/// Levels have this many steps in the table of logarithms.
const STEPS: usize = 4;

/// Each pixel's colour after smoothing: the mean of its channels' logarithms, which light shifts, and the differences of red
/// and blue from green, which it hardly changes.
pub(super) struct Colours {
    /// Mean of the logarithms.
    pub light: Vec<f32>,
    /// Bin of the differences.
    hue: Vec<u16>,
}

impl Colours {
    /// The colours of a picture of packed sRGB.
    pub fn new(w: usize, h: usize, rgb: &[u8]) -> Self {
        let logarithms: Vec<f32> =
            (0..256 * STEPS).map(|v| libm::logf((v as f32 + 0.5) / STEPS as f32 + DARK_LEVELS)).collect();
        // Rows first. The weights sum to 256, so that 16 bits suffice.
        let mut rows = vec![[0u16; 3]; w * h];
        let reach = WINDOW.len() / 2;
        for y in 0..h {
            for x in 0..w {
                let mut sums = [0u32; 3];
                for (k, weight) in WINDOW.into_iter().enumerate() {
                    let j = 3 * (y * w + (x + k).saturating_sub(reach).min(w - 1));
                    (0..3).for_each(|c| sums[c] += weight * u32::from(rgb[j + c]));
                }
                rows[y * w + x] = sums.map(|s| s as u16);
            }
        }
        let (mut light, mut hue) = (Vec::with_capacity(w * h), Vec::with_capacity(w * h));
        for y in 0..h {
            for x in 0..w {
                let mut sums = [0u32; 3];
                for (k, weight) in WINDOW.into_iter().enumerate() {
                    let pixel = rows[(y + k).saturating_sub(reach).min(h - 1) * w + x];
                    (0..3).for_each(|c| sums[c] += weight * u32::from(pixel[c]));
                }
                let [r, g, b] = sums.map(|s| logarithms[(s as usize * STEPS) >> 16]);
                light.push((r + g + b) / 3.0);
                let bin = |v: f32| (((v + WIDEST) * (HUE as f32 / (2.0 * WIDEST))).max(0.0) as usize).min(HUE - 1);
                hue.push((bin(r - g) * HUE + bin(b - g)) as u16);
            }
        }
        Self { light, hue }
    }

    /// Bin of a pixel's colour if its light were less by a difference of logarithms.
    pub fn bin(&self, i: usize, less: f32) -> usize {
        let light = (self.light[i] - less - DARKEST) * (LIGHT as f32 / (BRIGHTEST - DARKEST));
        (light.max(0.0) as usize).min(LIGHT - 1) * HUE * HUE + usize::from(self.hue[i])
    }
}
