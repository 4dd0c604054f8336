//! Wider vector instructions where the processor has them.
//!
//! The same code is compiled twice: for the instructions that every processor of the architecture has, and for AVX2.
//! Neither fuses multiplication and addition nor reorders sums, so that both give the same bits.
#![allow(unsafe_code)]

mod work;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use work::Work;

/// Which instructions to use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simd {
    /// What the crate was compiled for.
    Baseline,
    /// 256-bit vectors.
    #[cfg(target_arch = "x86_64")]
    Avx2,
}

impl Simd {
    /// The widest that this processor and its operating system offer; in builds with `--cfg pcmvs_baseline`, which
    /// tell what the others gain, what the crate was compiled for.
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if cfg!(not(pcmvs_baseline)) && x86::has_avx2() {
            return Self::Avx2;
        }
        Self::Baseline
    }

    /// Does `work` with these instructions.
    #[inline(always)]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        match self {
            Self::Baseline => work.run(),
            // SAFETY: the variant is made only where the processor has AVX2.
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => unsafe { x86::with_avx2(work) },
        }
    }
}
