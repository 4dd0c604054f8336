//! Work that is compiled once per set of instructions.

/// Work for [`Simd::run`]. It is compiled anew for each set of instructions as far as it is inlined: `run` and all that
/// should be wide must be `#[inline(always)]`, which closures cannot be.
pub trait Work {
    /// The result.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}
