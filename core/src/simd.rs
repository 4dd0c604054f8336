//! Wider vector instructions where the processor has them.
//!
//! The same code is compiled twice, for the instructions that every processor of the kind has and for AVX2. Neither
//! fuses multiplication and addition nor reorders sums, so that both give the same bits.
#![allow(unsafe_code)]

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

/// Work for [`Simd::run`]. It is compiled anew for each set of instructions as far as it is inlined: `run` and all that
/// should be wide must be `#[inline(always)]`, which closures cannot be.
pub trait Work {
    /// What comes out.
    type Output;
    /// Does it.
    fn run(self) -> Self::Output;
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Work;
    use core::arch::x86_64::{__cpuid, __cpuid_count, __get_cpuid_max, _xgetbv};

    #[target_feature(enable = "avx2")]
    pub(super) fn with_avx2<W: Work>(work: W) -> W::Output {
        work.run()
    }

    /// AVX2 exists, and the operating system keeps its registers.
    pub(super) fn has_avx2() -> bool {
        const OSXSAVE_AND_AVX: u32 = 1 << 27 | 1 << 28;
        const XMM_AND_YMM: u64 = 0b110;
        const AVX2: u32 = 1 << 5;
        #[target_feature(enable = "xsave")]
        fn kept() -> bool {
            // SAFETY: the function is called only where the instruction exists.
            unsafe { _xgetbv(0) & XMM_AND_YMM == XMM_AND_YMM }
        }
        // SAFETY: every x86-64 processor has cpuid.
        unsafe {
            __get_cpuid_max(0).0 >= 7
                && __cpuid(1).ecx & OSXSAVE_AND_AVX == OSXSAVE_AND_AVX
                && kept()
                && __cpuid_count(7, 0).ebx & AVX2 != 0
        }
    }
}
