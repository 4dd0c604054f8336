//! Gaussian blur.

/// Blurs a plane of values, by rows, with a Gaussian of standard deviation `sigma` in pixels: rows, then columns. Pixels
/// of the border are repeated outside.
pub fn gaussian(plane: &[f64], width: u32, height: u32, sigma: f64) -> Vec<f64> {
    let reach = libm::ceil(3.0 * sigma) as i64;
    let weights: Vec<f64> = (-reach..=reach).map(|i| libm::exp(-0.5 * (i * i) as f64 / (sigma * sigma))).collect();
    let total: f64 = weights.iter().sum();
    let along = |plane: &[f64], dx: i64, dy: i64| -> Vec<f64> {
        let clamped = |v: i64, size: u32| v.clamp(0, i64::from(size) - 1);
        let pixels = (0..i64::from(height)).flat_map(|y| (0..i64::from(width)).map(move |x| (x, y)));
        pixels
            .map(|(x, y)| {
                let mut sum = 0.0;
                for (i, w) in (-reach..=reach).zip(&weights) {
                    let (u, v) = (clamped(x + i * dx, width), clamped(y + i * dy, height));
                    sum += w * plane[(v * i64::from(width) + u) as usize];
                }
                sum / total
            })
            .collect()
    };
    along(&along(plane, 1, 0), 0, 1)
}
