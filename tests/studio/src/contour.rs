//! Masks whose contours lie beside the true ones.

use crate::{blur::gaussian, noise::Random};
use glam::DVec2;

/// Standard deviation in pixels of the Gaussian that makes smooth errors of white noise. Errors of places 12 pixels apart
/// correlate by 0.78, those of places 40 pixels apart by 0.06.
const SMOOTHNESS: f64 = 12.0;

/// Coverage (0..=1, by rows) whose half-level contour lies outside the given one's by `wider` pixels, which may be negative,
/// and by a smooth random error with a root mean square of `error` pixels along the contour. Edges are one pixel soft. A
/// contour that the picture's edge cuts off ends there.
pub fn displaced(coverage: &[f64], width: u32, height: u32, wider: f64, error: f64, random: &mut Random) -> Vec<f64> {
    let contour = Contour::new(coverage, width, height);
    let mut offsets = if error > 0.0 { contour.smooth_errors(error, random) } else { vec![0.0; coverage.len()] };
    offsets.iter_mut().for_each(|offset| *offset += wider);
    // Pixels farther than this from the given contour lie wholly on one side of both contours.
    let reach = 1.0 + offsets.iter().fold(0.0, |most: f64, offset| most.max(libm::fabs(*offset)));
    let distances = contour.distances(reach);
    distances.iter().zip(&offsets).map(|(distance, offset)| (0.5 + distance + offset).clamp(0.0, 1.0)).collect()
}

/// The half-level contour of a coverage.
pub struct Contour<'a> {
    coverage: &'a [f64],
    width: u32,
    height: u32,
    /// Pieces of the contour, in pixels. They have no order.
    pieces: Vec<[DVec2; 2]>,
}

impl<'a> Contour<'a> {
    /// The contour of a coverage (0..=1, by rows), interpolated linearly between the centres of pixels.
    pub fn new(coverage: &'a [f64], width: u32, height: u32) -> Self {
        let at = |x: u32, y: u32| coverage[(y * width + x) as usize];
        let mut pieces = Vec::new();
        for y in 0..height.saturating_sub(1) {
            for x in 0..width.saturating_sub(1) {
                let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
                let mut crossings = Vec::new();
                for (i, &(x0, y0)) in corners.iter().enumerate() {
                    let (x1, y1) = corners[(i + 1) % 4];
                    let (a, b) = (at(x0, y0) - 0.5, at(x1, y1) - 0.5);
                    if (a >= 0.0) != (b >= 0.0) {
                        let from = DVec2::new(f64::from(x0), f64::from(y0));
                        crossings.push(from.lerp(DVec2::new(f64::from(x1), f64::from(y1)), a / (a - b)));
                    }
                }
                // Two contours that meet in one cell are less than a pixel apart, so that either way to connect them will do.
                pieces.extend(crossings.chunks_exact(2).map(|ends| [ends[0], ends[1]]));
            }
        }
        Self { coverage, width, height, pieces }
    }

    /// Distances of all pixels from the contour in pixels: positive inside, at most `reach` on either side.
    pub fn distances(&self, reach: f64) -> Vec<f64> {
        let mut distances = vec![reach; self.coverage.len()];
        let pixels = |low: f64, high: f64, size: u32| {
            let from = libm::ceil(low - reach).max(0.0) as u32;
            let to = libm::floor(high + reach).clamp(0.0, f64::from(size - 1)) as u32;
            from..=to
        };
        for &[a, b] in &self.pieces {
            let (low, high) = (a.min(b), a.max(b));
            for y in pixels(low.y, high.y, self.height) {
                for x in pixels(low.x, high.x, self.width) {
                    let nearest = &mut distances[(y * self.width + x) as usize];
                    *nearest = nearest.min(distance(DVec2::new(f64::from(x), f64::from(y)), a, b));
                }
            }
        }
        let signed = |(distance, inside): (f64, &f64)| if *inside >= 0.5 { distance } else { -distance };
        distances.into_iter().zip(self.coverage).map(signed).collect()
    }

    /// Smooth random values of all pixels whose root mean square along the contour is `error`.
    fn smooth_errors(&self, error: f64, random: &mut Random) -> Vec<f64> {
        let white: Vec<f64> = self.coverage.iter().map(|_| random.normal()).collect();
        let mut smooth = gaussian(&white, self.width, self.height, SMOOTHNESS);
        let (mut squares, mut length) = (0.0, 0.0);
        for [a, b] in &self.pieces {
            let middle = (*a + *b) * 0.5;
            let (x, y) = ((middle.x + 0.5) as u32, (middle.y + 0.5) as u32);
            let value = smooth[(y * self.width + x) as usize];
            squares += value * value * (*b - *a).length();
            length += (*b - *a).length();
        }
        let scale = if squares > 0.0 { error * libm::sqrt(length / squares) } else { 0.0 };
        smooth.iter_mut().for_each(|value| *value *= scale);
        smooth
    }
}

/// Distance of a point from a piece of a line.
fn distance(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let (along, to) = (b - a, point - a);
    let length = along.length_squared();
    let share = if length > 0.0 { (to.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (to - along * share).length()
}
