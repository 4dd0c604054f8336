//! Selects wider vector instructions on processors that have them.
//!
//! The same code is compiled twice on x86-64: for the baseline instructions of the architecture, and for AVX2. Neither
//! version fuses multiplications and additions or reorders sums, so that both give the same bits.
#![allow(unsafe_code)]

mod work;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use work::Work;
#[cfg(all(target_arch = "x86_64", target_feature = "sse"))]
pub use x86::sqrt;

/// The same as `v as i32`, for loops that become vectors. Elsewhere it takes longer.
#[inline(always)]
pub fn truncate(v: f32) -> i32 {
    #[cfg(target_arch = "x86_64")]
    {
        x86::truncate(v)
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        v as i32
    }
}

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
        let positive = [0.0, 1e-40, 0.5, 0.999_999_9, 1.0, 1.5, 16_777_215.0, 1e9, 2_147_483_520.0, 2_147_483_648.0];
        let positive = positive.into_iter().chain([2_147_483_904.0, 1e20, f32::INFINITY, f32::NAN]);
        for v in positive.flat_map(|v| [v, -v]) {
            assert_eq!(truncate(v), v as i32, "{v}");
        }
    }
}
