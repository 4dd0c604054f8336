//! Robust statistics. Ties and order do not matter, because values are sorted.

use crate::sort;
use alloc::vec::Vec;

/// The median; `None` of no values. The values are reordered.
pub(super) fn median(values: &mut [f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The value below which a share (0..=1) of the values lies.
pub(super) fn quantile(values: &mut [f64], share: f64) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    // As integers, which other code sorts, too.
    let mut keys: Vec<u64> = values.iter().map(|&v| ordered(v)).collect();
    sort::numbers(&mut keys);
    values.iter_mut().zip(keys).for_each(|(v, key)| *v = from_ordered(key));
    Some(values[((values.len() - 1) as f64 * share + 0.5) as usize])
}

/// Maps a number to an integer such that the integers sort in the order of [`f64::total_cmp`].
fn ordered(v: f64) -> u64 {
    let bits = v.to_bits();
    if bits >> 63 == 0 { bits | 1 << 63 } else { !bits }
}

/// The inverse of [`ordered`].
fn from_ordered(order: u64) -> f64 {
    f64::from_bits(if order >> 63 == 1 { order & !(1 << 63) } else { !order })
}

/// The standard deviation of a normal distribution with the same median absolute value.
pub(super) fn robust_sigma(values: &[f64]) -> Option<f64> {
    let mut sizes: Vec<f64> = values.iter().map(|v| v.abs()).collect();
    median(&mut sizes).map(|m| 1.4826 * m)
}
