//! AVX2: detection, and code that is compiled for it.

use super::work::Work;
use core::arch::x86_64::{__cpuid, __cpuid_count, __get_cpuid_max, _xgetbv};
#[cfg(target_feature = "sse")]
use core::arch::x86_64::{_mm_cvtss_f32, _mm_set_ss, _mm_sqrt_ss};

#[target_feature(enable = "avx2")]
pub(super) fn with_avx2<W: Work>(work: W) -> W::Output {
    work.run()
}

/// Whether the processor has AVX2 and the operating system saves its registers (Intel 64 and IA-32 Architectures
/// Software Developer's Manual, volume 1, "Detection of Intel AVX2").
pub(super) fn has_avx2() -> bool {
    const OSXSAVE_AND_AVX: u32 = 1 << 27 | 1 << 28;
    const XMM_AND_YMM: u64 = 0b110;
    const AVX2: u32 = 1 << 5;
    #[target_feature(enable = "xsave")]
    fn kept() -> bool {
        // SAFETY: this is called only after OSXSAVE has been checked, which implies that the instruction exists.
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

/// The square root. Unlike assembly, the compiler knows it, and puts several into one instruction.
#[cfg(target_feature = "sse")]
#[inline(always)]
pub fn sqrt(v: f32) -> f32 {
    // SAFETY: SSE is among the instructions that the crate is compiled for.
    unsafe { _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(v))) }
}

/// `v as i32`, which saturates, and is 0 for NaN. The compiler would turn that into branches for each lane of a vector.
#[inline(always)]
pub fn truncate(v: f32) -> i32 {
    const LOW: f32 = i32::MIN as f32;
    // The largest number that an `i32` can hold.
    const HIGH: f32 = 2_147_483_520.0;
    let number = if v.is_nan() { 0.0 } else { v };
    let bounded = if number < HIGH { number } else { HIGH };
    let bounded = if bounded > LOW { bounded } else { LOW };
    // SAFETY: it is a number, and between two that an `i32` can hold.
    let integer: i32 = unsafe { bounded.to_int_unchecked() };
    if v > HIGH { i32::MAX } else { integer }
}
