//! Finds where another picture shows the surroundings of a pixel: first by correlation over a square of displacements,
//! then between the pixels by least squares (Gruen, Adaptive Least Squares Correlation, 1985).

use super::smooth::Smooth;
use alloc::vec::Vec;
use glam::{Mat2, Vec2};
use nalgebra::{Cholesky, SMatrix, SVector};

/// Half the edge of the windows that are correlated, in pixels of the first picture.
const WINDOW: usize = 5;
/// Half the edge of the windows that are fitted.
const FITTED: i32 = 7;
/// How far from a corner pixels are read.
pub(super) const MARGIN: usize = FITTED as usize + 1;
/// Pixels of a window that is correlated.
const AREA: usize = (2 * WINDOW + 1) * (2 * WINDOW + 1);

/// Windows with a smaller root of their sum of squares are flat, in grey levels.
const LEAST_LENGTH: f32 = 5.0;
/// Least correlation (ZNCC) of a match.
const LEAST_SCORE: f32 = 0.75;
/// Least correlation after the fit.
const LEAST_FIT: f32 = 0.88;
/// The best peak must be better than every other one by this much.
const DISTINCT: f32 = 0.05;
/// Displacements within this many pixels of a peak belong to it.
const PEAK: i32 = 3;
/// Steps of the fit.
const STEPS: usize = 12;
/// The fit has converged when it moves by less than this many pixels.
const CONVERGED: f64 = 0.005;
/// A fit that moves farther than this, in pixels, has left its peak.
const FARTHEST: f32 = 2.5;
/// No match is more precise than this, in pixels.
const LEAST_SIGMA: f64 = 0.08;
/// Noise of neighbouring pixels is correlated, so that the fit's own estimate is too small by about this factor.
const CORRELATED: f64 = 2.0;

/// A match.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Match {
    /// Pixel of the other picture.
    pub(super) pixel: Vec2,
    /// Standard deviation in pixels.
    pub(super) sigma: f64,
    /// Mean brightness of the other window over that of the first one.
    pub(super) gain: f32,
}

/// Luma in the geometry of the first picture: a square of `2 * half + 1` pixels.
struct Field {
    edge: usize,
    values: Vec<f32>,
}

/// A window with mean zero and length one.
type Window = [f32; AREA];

impl Field {
    fn new(half: usize, sample: impl Fn(f32, f32) -> Option<f32>) -> Option<Self> {
        let edge = 2 * half + 1;
        let mut values = Vec::with_capacity(edge * edge);
        for y in 0..edge {
            for x in 0..edge {
                values.push(sample(x as f32 - half as f32, y as f32 - half as f32)?);
            }
        }
        Some(Self { edge, values })
    }

    /// The pixels around a displacement from the middle.
    #[inline]
    fn pixels(&self, dx: i32, dy: i32) -> Window {
        let half = (self.edge / 2) as i32;
        let (x, y) = ((half + dx) as usize - WINDOW, (half + dy) as usize - WINDOW);
        let mut out = [0.0; AREA];
        for (row, line) in out.chunks_exact_mut(2 * WINDOW + 1).enumerate() {
            line.copy_from_slice(&self.values[(y + row) * self.edge + x..][..2 * WINDOW + 1]);
        }
        out
    }

    /// [`Self::pixels`] as a window; `None` if they are flat.
    fn window(&self, dx: i32, dy: i32) -> Option<Window> {
        let mut out = self.pixels(dx, dy);
        let mean = dot(&out, &[1.0; AREA]) / AREA as f32;
        out.iter_mut().for_each(|v| *v -= mean);
        let length = libm::sqrtf(dot(&out, &out));
        if !(length > LEAST_LENGTH) {
            return None;
        }
        out.iter_mut().for_each(|v| *v /= length);
        Some(out)
    }

    /// The correlation with a window at each displacement of at most `reach` pixels, row after row.
    fn scores(&self, window: &Window, reach: i32) -> Vec<f32> {
        let mut scores = Vec::with_capacity(((2 * reach + 1) * (2 * reach + 1)) as usize);
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                let other = self.pixels(dx, dy);
                // The window has mean zero, so that the mean of the other one does not matter.
                let mean = dot(&other, &[1.0; AREA]) / AREA as f32;
                let spread = dot(&other, &other) - mean * mean * AREA as f32;
                let flat = !(spread > LEAST_LENGTH * LEAST_LENGTH);
                scores.push(if flat { -1.0 } else { dot(window, &other) / libm::sqrtf(spread) });
            }
        }
        scores
    }

    /// The displacement of at most `reach` pixels at which the field correlates best with a window; `None` if no score is
    /// high enough. If `distinct`, also if another peak is nearly as high, or if the peak may lie beyond the reach.
    fn search(&self, window: &Window, reach: i32, distinct: bool) -> Option<[i32; 2]> {
        let scores = self.scores(window, reach);
        let edge = 2 * reach + 1;
        let place = |i: usize| [i as i32 % edge - reach, i as i32 / edge - reach];
        let best = (0..scores.len()).reduce(|best, i| if scores[i] > scores[best] { i } else { best })?;
        let [x, y] = place(best);
        if !(scores[best] >= LEAST_SCORE) {
            return None;
        }
        if distinct {
            let is_apart = |i: &usize| {
                let [u, v] = place(*i);
                (u - x).abs() > PEAK || (v - y).abs() > PEAK
            };
            let rival = (0..scores.len()).filter(is_apart).map(|i| scores[i]).fold(-1.0, f32::max);
            if x.abs() == reach || y.abs() == reach || !(scores[best] - rival >= DISTINCT) {
                return None;
            }
        }
        Some([x, y])
    }
}

/// Scalar product in eight lanes, in an order that does not depend on the machine.
#[inline]
fn dot(a: &Window, b: &Window) -> f32 {
    let mut lanes = [0.0; 8];
    let (of_a, of_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = of_a.remainder().iter().zip(of_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in of_a.zip(of_b) {
        (0..8).for_each(|k| lanes[k] += a[k] * b[k]);
    }
    lanes.iter().sum::<f32>() + rest
}

/// Finds the match of a pixel of one picture in another one. `expected` is where it should be, `affine` maps offsets in
/// the first picture to offsets in the other one, and `reach` is how far the match may be from `expected`, in pixels of
/// the first picture. The match must also lead back.
pub(super) fn find(
    [first, other]: [&Smooth; 2],
    corner: [u16; 2],
    expected: Vec2,
    affine: Mat2,
    reach: usize,
) -> Option<Match> {
    let [x, y] = corner.map(usize::from);
    let own_reach = reach.min(x - MARGIN).min(y - MARGIN);
    let own_reach = own_reach.min(first.width - 1 - MARGIN - x).min(first.height - 1 - MARGIN - y);
    let sample_own = |dx: f32, dy: f32| first.sample(Vec2::new(x as f32 + dx, y as f32 + dy));
    let own = Field::new(WINDOW + own_reach, sample_own)?;
    let there = Field::new(WINDOW + reach, |dx, dy| other.sample(expected + affine * Vec2::new(dx, dy)))?;
    let [dx, dy] = there.search(&own.window(0, 0)?, reach as i32, true)?;
    // Back: what was found there must be most like the place where the search began.
    let back = own.search(&there.window(dx, dy)?, own_reach as i32, false)?;
    if back[0].abs() > 1 || back[1].abs() > 1 {
        return None;
    }
    fit(first, [x, y], other, expected + affine * Vec2::new(dx as f32, dy as f32), affine)
}

/// Fits position and affine map of a window, and the brightness and contrast of the other picture.
fn fit(first: &Smooth, [x, y]: [usize; 2], other: &Smooth, start: Vec2, affine: Mat2) -> Option<Match> {
    const COUNT: usize = ((2 * FITTED + 1) * (2 * FITTED + 1)) as usize;
    let (mut at, mut map) = (start, affine);
    let offsets = || (-FITTED..=FITTED).flat_map(|v| (-FITTED..=FITTED).map(move |u| (u, v)));
    let (mut gain, mut bias) = (1.0_f64, 0.0_f64);
    let mut state = None;
    for step in 0..STEPS {
        let mut normal = SMatrix::<f64, 8, 8>::zeros();
        let mut right = SVector::<f64, 8>::zeros();
        let (mut squares, mut sums) = (0.0, [0.0_f64; 5]);
        for (u, v) in offsets() {
            let p = at + map * Vec2::new(u as f32, v as f32);
            let value = f64::from(other.sample(p)?);
            let along = |d: Vec2| Some(f64::from(other.sample(p + d)?) - f64::from(other.sample(p - d)?));
            let (gx, gy) = (along(Vec2::X)? * 0.5 * gain, along(Vec2::Y)? * 0.5 * gain);
            let own = f64::from(first.at((x as i32 + u) as usize, (y as i32 + v) as usize));
            let (u, v) = (f64::from(u), f64::from(v));
            let row = SVector::<f64, 8>::from([gx, gy, gx * u, gx * v, gy * u, gy * v, value, 1.0]);
            let residual = own - (gain * value + bias);
            for i in 0..8 {
                right[i] += row[i] * residual;
                for j in 0..=i {
                    normal[(i, j)] += row[i] * row[j];
                }
            }
            squares += residual * residual;
            for (sum, value) in sums.iter_mut().zip([own, value, own * own, value * value, own * value]) {
                *sum += value;
            }
        }
        let factors = Cholesky::new(normal)?;
        let delta = factors.solve(&right);
        at += Vec2::new(delta[0] as f32, delta[1] as f32);
        map.x_axis += Vec2::new(delta[2] as f32, delta[4] as f32);
        map.y_axis += Vec2::new(delta[3] as f32, delta[5] as f32);
        gain += delta[6];
        bias += delta[7];
        if !((at - start).length() < FARTHEST) {
            return None;
        }
        let moved = libm::sqrt(delta[0] * delta[0] + delta[1] * delta[1]);
        if moved < CONVERGED && step > 0 {
            state = Some((factors.inverse(), squares, sums));
            break;
        }
    }
    let (inverse, squares, [a, b, aa, bb, ab]) = state?;
    let n = COUNT as f64;
    let (spread_a, spread_b) = (aa - a * a / n, bb - b * b / n);
    let score = (ab - a * b / n) / libm::sqrt(spread_a * spread_b);
    if !(score as f32 >= LEAST_FIT && a > 0.0 && b > 0.0) {
        return None;
    }
    let noise = squares / (n - 8.0);
    let variance = noise * 0.5 * (inverse[(0, 0)] + inverse[(1, 1)]);
    let sigma = libm::sqrt(LEAST_SIGMA * LEAST_SIGMA + variance * CORRELATED * CORRELATED);
    Some(Match { pixel: at, sigma, gain: (b / a) as f32 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern(p: Vec2) -> f32 {
        let wave = |x: f32, y: f32, f: f32| libm::sinf((p.x * x + p.y * y) * f);
        120.0 + 40.0 * wave(1.0, 0.3, 0.31) + 30.0 * wave(-0.4, 1.0, 0.43) + 20.0 * wave(0.8, -0.9, 0.19)
    }

    fn picture(f: impl Fn(Vec2) -> f32) -> Smooth {
        let at = |i: usize| f(Vec2::new((i % 120) as f32, (i / 120) as f32)) as u8;
        Smooth::new(&(0..120 * 100).map(at).collect::<Vec<u8>>(), 120, 100)
    }

    #[test]
    fn warped_pictures_are_matched_to_a_twentieth_of_a_pixel() {
        let warp = Mat2::from_cols(Vec2::new(0.93, 0.05), Vec2::new(-0.08, 1.06));
        let (from, to) = (Vec2::new(60.0, 50.0), Vec2::new(58.37, 47.81));
        let first = picture(pattern);
        // Darker, as another camera may see it.
        let other = picture(|p| 0.8 * pattern(from + warp.inverse() * (p - to)) + 5.0);
        for expected in [to + Vec2::new(4.0, -5.0), to + Vec2::new(-2.6, 3.2)] {
            let found = find([&first, &other], [60, 50], expected, warp, 7).expect("a match");
            assert!((found.pixel - to).length() < 0.05, "{found:?}");
            assert!(found.sigma < 0.15, "{found:?}");
        }
        assert_eq!(find([&first, &other], [60, 50], to + Vec2::new(12.0, 0.0), warp, 3), None);
    }

    #[test]
    fn repeated_texture_is_not_matched() {
        let stripes = |p: Vec2| 120.0 + 50.0 * libm::sinf(p.x * 1.2) * libm::sinf(p.y * 1.2);
        let first = picture(stripes);
        assert_eq!(find([&first, &first], [60, 50], Vec2::new(60.0, 50.0), Mat2::IDENTITY, 7), None);
    }
}
