//! Work that is compiled once per set of instructions.

/// Work for [`super::Simd::run`]. Code is compiled for wider instructions only where it is inlined. Therefore `run` and
/// all functions in its inner loops must be `#[inline(always)]`, which is not possible for closures.
pub trait Work {
    /// The result.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}
