//! Rounding, comparison and roots in basic arithmetic. They give the same bits on every platform, and compilers can
//! vectorise them.

use alloc::vec::Vec;

/// The larger number, or `b` if either is NaN. Unlike `f32::max` it compiles to an instruction on every target,
/// WebAssembly included, and it is defined which zero it returns: `b` if both are zero.
#[inline(always)]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller number, or `b` if either is NaN; see [`max`].
#[inline(always)]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The square root, correctly rounded as IEEE 754 requires. `libm` would compute it in software on WebAssembly, and one at a
/// time on x86-64, where loops take several at once.
#[inline]
pub fn sqrt(v: f32) -> f32 {
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    {
        use core::arch::wasm32::{f32x4_extract_lane, f32x4_splat, f32x4_sqrt};
        f32x4_extract_lane::<0>(f32x4_sqrt(f32x4_splat(v)))
    }
    #[cfg(all(target_arch = "x86_64", target_feature = "sse"))]
    {
        crate::simd::sqrt(v)
    }
    #[cfg(not(any(
        all(target_arch = "x86_64", target_feature = "sse"),
        all(target_arch = "wasm32", target_feature = "simd128")
    )))]
    libm::sqrtf(v)
}

/// Maps a number to an integer such that the integers sort in the order of [`f32::total_cmp`]. Integers sort faster
/// than numbers.
#[inline]
pub fn ordered(v: f32) -> u32 {
    let bits = v.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}

/// The inverse of [`ordered`].
#[inline]
pub fn from_ordered(order: u32) -> f32 {
    f32::from_bits(if order >> 31 == 1 { order & !(1 << 31) } else { !order })
}

/// The number that the given fraction of all, numerator and denominator, is smaller than: of two the larger one. `None` of none.
pub fn quantile(values: impl Iterator<Item = f32>, [part, of]: [usize; 2]) -> Option<f32> {
    let mut keys: Vec<u32> = values.map(ordered).collect();
    sort(&mut keys);
    keys.get(keys.len() * part / of).copied().map(from_ordered)
}

/// Sorts. Apart, so that it is compiled once.
#[inline(never)]
fn sort(keys: &mut [u32]) {
    keys.sort_unstable();
}

/// The number at a place of the list once it is sorted. The standard library's selection takes less time, and kilobytes of code
/// more.
pub fn select(values: &mut [u32], place: usize) -> u32 {
    sort(values);
    values[place]
}

/// The median, the larger one of two.
pub fn median(values: impl Iterator<Item = f32>) -> Option<f32> {
    quantile(values, [1, 2])
}

/// The largest integer not greater than `v`. It saturates, and NaN gives 0.
#[inline]
pub fn floor(v: f32) -> i32 {
    let t = v as i32;
    t - i32::from(v < t as f32)
}

/// The integer and the fractional part of v, for 0 ≤ v < 2²². If v is an integer the parts may be v - 1 and 1.
#[inline]
pub fn split(v: f32) -> (u32, f32) {
    // Numbers from 2²³ to 2²⁴ have no fractional bits. The sum is therefore rounded to an integer, which can be read
    // from its mantissa.
    const INTEGERS: f32 = 12_582_912.0;
    let rounded = (v - 0.5) + INTEGERS;
    (rounded.to_bits() - INTEGERS.to_bits(), v - (rounded - INTEGERS))
}

/// 1/√x for normal positive x, to within 3 units in the last place.
///
/// The first estimate halves the exponent in integer arithmetic (the "fast inverse square root"; the constant is that
/// of Lomont, Fast Inverse Square Root, 2003). Three Newton iterations follow.
#[inline]
pub fn inverse_sqrt(x: f32) -> f32 {
    let mut y = f32::from_bits(0x5f37_5a86 - (x.to_bits() >> 1));
    let half = 0.5 * x;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y * (1.5 - half * y * y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_roots_are_right_over_all_exponents() {
        for exponent in 1..254u32 {
            for mantissa in [0, 1, 0x20_0000, 0x35_04f3, 0x40_0000, 0x7f_ffff] {
                let x = f32::from_bits(exponent << 23 | mantissa);
                let exact = 1.0 / libm::sqrt(f64::from(x));
                assert!((f64::from(inverse_sqrt(x)) / exact - 1.0).abs() < 3.6e-7, "{x:e}");
            }
        }
    }

    #[test]
    fn integers_are_in_the_order_of_numbers() {
        let numbers = [-f32::INFINITY, -1e30, -1.0, -1e-40, -0.0, 0.0, 1e-40, 0.5, 1.0, 1e30, f32::INFINITY, f32::NAN];
        for pair in numbers.windows(2) {
            assert!(ordered(pair[0]) < ordered(pair[1]), "{pair:?}");
        }
        for number in numbers {
            assert_eq!(from_ordered(ordered(number)).to_bits(), number.to_bits());
        }
    }

    #[test]
    fn parts_add_up() {
        for v in [0.0, 0.25, 0.499_999_97, 0.5, 0.75, 0.999_999_94, 1.0, 1.5, 2.0, 2.5, 1022.999, 4_194_303.5] {
            let (integer, fraction) = split(v);
            assert_eq!(integer as f32 + fraction, v);
            assert!((0.0..=1.0).contains(&fraction) && integer <= v as u32, "{v}: {integer} + {fraction}");
        }
    }

    #[test]
    fn floors_agree_with_the_library() {
        for v in [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 1e-30, -1e-30, 2.999_999_8, -2.999_999_8, 8_388_607.5, -8_388_607.5]
        {
            assert_eq!(floor(v), libm::floorf(v) as i32, "{v}");
        }
        assert_eq!(floor(f32::NAN), 0);
    }
}
