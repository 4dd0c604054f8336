//! Selects wider vector instructions on processors that have them.
//!
//! The same code is compiled twice on x86-64: for the baseline instructions of the architecture, and for AVX2. Neither
//! version fuses multiplications and additions or reorders sums, so that both give the same bits.
#![allow(unsafe_code)]

mod work;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use work::Work;
#[cfg(target_arch = "x86_64")]
pub use x86::sqrt;

use crate::math::{max, min};

/// The integer part of `v`. It saturates, at ±[`MOST`], and NaN gives 0.
///
/// `as` gives the same, but on x86-64 the compiler turns it into branches for each lane of a vector.
#[inline(always)]
pub fn truncate(v: f32) -> i32 {
    let v = if v.is_nan() { 0.0 } else { max(min(v, MOST), -MOST) };
    // SAFETY: it is a number between two that an `i32` can hold.
    unsafe { v.to_int_unchecked() }
}

/// The largest `f32` that an `i32` can hold.
const MOST: f32 = 2_147_483_520.0;

/// Which instructions to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simd {
    /// The instructions that the crate was compiled for.
    Baseline,
    /// 256-bit vectors.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Simd {
    /// The widest instructions that the processor and the operating system support. Always [`Self::Baseline`] in builds
    /// with `--cfg pcmvs_baseline`, which serve to measure the gain of AVX2.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if cfg!(not(pcmvs_baseline)) && x86::has_avx2() {
            return Self::Avx2;
        }
        Self::Baseline
    }

    /// Runs `work` with these instructions.
    #[inline(always)]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        match self {
            Self::Baseline => work.run(),
            // SAFETY: this variant is created only if the processor has AVX2.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { x86::with_avx2(work) },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integer_parts_are_those_of_a_conversion() {
        let values = [0.0, 0.5, 0.999_999_9, 1.0, 1.5, 16_777_215.0, 1e9, MOST, 1e-40];
        for v in values.into_iter().flat_map(|v| [v, -v]).chain([f32::NAN]) {
            assert_eq!(truncate(v), v as i32, "{v}");
        }
        for v in [2e9_f32, 2_147_483_648.0, 1e20, f32::INFINITY] {
            assert_eq!(truncate(v), v.min(MOST) as i32, "{v}");
            assert_eq!(truncate(-v), -truncate(v), "{v}");
        }
    }
}
