//! Robust statistics. Ties and order do not matter, because values are sorted.

/// The median; `None` of no values. The values are reordered.
pub(super) fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The value below which a share (0..=1) of the values lies.
pub(super) fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    values.sort_unstable_by(f64::total_cmp);
    Some(values[((values.len() - 1) as f64 * share + 0.5) as usize])
}

/// The standard deviation of a normal distribution with the same median absolute value.
pub(super) fn robust_sigma(values: &[f64]) -> Option<f64> {
    let mut sizes: alloc::vec::Vec<f64> = values.iter().map(|v| v.abs()).collect();
    median(&mut sizes).map(|m| 1.4826 * m)
}
