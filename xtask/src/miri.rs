//! `cargo xtask miri`: runs tests under Miri, an interpreter that finds undefined behaviour.

use crate::{
    Result,
    process::{program, run as run_program, target},
    setup::Need,
    steps::Outcome,
};

/// Miri is in nightly compilers only. Without one the check is skipped.
pub const NEEDS: [Need; 1] = [Need::Nightly("miri")];

/// Packages, the arguments of `cargo miri test` for each, and parts of the names of tests. Only quick ones are chosen, because
/// Miri takes tens of thousands of times as long as the processor: a frame of four views of 24 x 24 pixels was not finished after
/// 21 minutes. The feature of libm computes square roots without inline assembly, which Miri cannot run.
const TESTS: [(&str, &str, &[&str]); 2] =
    [("pcmvs-ffi", "--lib", &[]), ("pcmvs-core", "--features libm/force-soft-floats --lib --", &OF_CORE)];
/// Parts of the core: memory and numbers, lenses, the adjustment of the calibration, clean-up of the coarse pass, and votes.
const OF_CORE: [&str; 12] = [
    "workspace::",
    "image::",
    "math::",
    "lens::",
    "calibration::brightness",
    "calibration::in_step",
    "calibration::model",
    "calibration::smooth",
    "coarse::gaps",
    "coarse::seen_through",
    "detect::tests::vote::a",
    "detect::tests::vote::of_hypotheses",
];

/// The check.
pub fn check() -> Result<Outcome> {
    NEEDS[0].install()?;
    let mut passed = 0;
    for (package, arguments, names) in TESTS {
        let mut miri =
            program("rustup", &format!("run nightly cargo miri test --quiet --package {package} {arguments}"));
        miri.args(names);
        // The toolchain of the running Cargo must not be that of the nightly one.
        miri.env_remove("RUSTC").env_remove("CARGO").env_remove("RUSTUP_TOOLCHAIN");
        miri.env("CARGO_TARGET_DIR", target().join("miri"));
        let printed = run_program(&mut miri)?;
        let count = |line: &str| line.strip_prefix("test result: ok. ")?.split(' ').next()?.parse::<u32>().ok();
        passed += printed.lines().filter_map(count).sum::<u32>();
    }
    Ok(Outcome::Passed(format!("{passed} tests")))
}
