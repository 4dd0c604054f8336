//! A sensor behind a mosaic keeps smooth colours, and its noise correlates.

use studio::{Faults, Picture, render::Render};

const WIDTH: usize = 256;
const HEIGHT: usize = 192;

fn read(faults: &Faults, colour: impl Fn(f64, f64) -> [f64; 3]) -> Picture {
    let rgb = (0..WIDTH * HEIGHT).map(|i| colour((i % WIDTH) as f64, (i / WIDTH) as f64)).collect();
    let render = Render { rgb, coverage: vec![0.0; WIDTH * HEIGHT] };
    faults.picture(&render, WIDTH as u32, HEIGHT as u32, 0, 0)
}

/// Bilinear interpolation is exact where colours change evenly, and at the picture's edge where they do not change.
#[test]
fn colours_that_change_evenly_stay() {
    let (exact, mosaic) = (Faults::default(), Faults { mosaic: true, ..Faults::default() });
    let slope = |x: f64, y: f64| [0.2013 + 0.002 * x, 0.3013 + 0.001 * y, 0.7013 - 0.001 * x - 0.001 * y];
    let (a, b) = (read(&exact, slope), read(&mosaic, slope));
    for y in 1..HEIGHT - 1 {
        for i in 3 * (y * WIDTH + 1)..3 * (y * WIDTH + WIDTH - 1) {
            assert_eq!(a.rgb[i], b.rgb[i], "column {}, row {y}", i / 3 % WIDTH);
        }
    }
    let even = |_: f64, _: f64| [0.2, 0.5, 0.7];
    assert_eq!(read(&exact, even), read(&mosaic, even));
}

/// Standard deviation of values, and the correlations of those next to and below each other.
fn statistics(values: &[f64]) -> (f64, [f64; 2]) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let covariance = |step: usize| {
        let (mut sum, mut count) = (0.0, 0.0);
        for i in (0..values.len() - step).filter(|i| step != 1 || i % WIDTH + 1 < WIDTH) {
            sum += (values[i] - mean) * (values[i + step] - mean);
            count += 1.0;
        }
        sum / count
    };
    let variance = covariance(0);
    (libm::sqrt(variance), [1, WIDTH].map(|step| covariance(step) / variance))
}

#[test]
fn noise_of_neighbouring_pixels_correlates() {
    let gray = |_: f64, _: f64| [0.5; 3];
    let noisy = |mosaic: bool| read(&Faults { noise: 10.0, mosaic, ..Faults::default() }, gray);
    let weighted = |picture: &Picture, weights: [f64; 3]| {
        let luma = |p: &[u8]| (0..3).map(|c| weights[c] * f64::from(p[c])).sum::<f64>();
        statistics(&picture.rgb.chunks_exact(3).map(luma).collect::<Vec<_>>())
    };
    let (white, mosaic) = (noisy(false), noisy(true));
    // Weights of the channels, deviation and correlation that are to be expected.
    let expected = [
        ([1.0, 0.0, 0.0], 7.5, 0.667),
        ([0.0, 1.0, 0.0], 7.91, 0.4),
        ([0.0, 0.0, 1.0], 7.5, 0.667),
        ([0.299, 0.587, 0.114], 5.23, 0.456),
    ];
    for (weights, deviation, correlation) in expected {
        let (found, correlations) = weighted(&mosaic, weights);
        assert!((found / deviation - 1.0).abs() < 0.03, "{weights:?}: {found} instead of {deviation}");
        for found in correlations {
            assert!((found - correlation).abs() < 0.03, "{weights:?}: {found} instead of {correlation}");
        }
        assert!(weighted(&white, weights).1.iter().all(|c| c.abs() < 0.03));
    }
}
