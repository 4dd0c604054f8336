//! `cargo xtask miri`: runs tests under Miri, an interpreter that finds undefined behaviour.

use crate::{
    Result,
    process::{program, run as run_program, target},
    setup::Need,
    steps::Outcome,
};

/// Miri is in nightly compilers only. Without one the check is skipped.
pub const NEEDS: [Need; 1] = [Need::Nightly("miri")];

/// Packages, and the arguments of `cargo miri test` for each. Only quick tests are chosen, by parts of their names, because
/// Miri runs a program about 1000 times slower than the processor does. The feature of libm computes square roots without
/// inline assembly, which Miri cannot run.
const TESTS: [(&str, &str); 2] =
    [("pcmvs-ffi", "--lib"), ("pcmvs-core", "--features libm/force-soft-floats --lib -- workspace:: image:: math::")];

/// The check.
pub fn check() -> Result<Outcome> {
    NEEDS[0].install()?;
    let mut passed = 0;
    for (package, tests) in TESTS {
        let mut miri = program("rustup", &format!("run nightly cargo miri test --quiet --package {package} {tests}"));
        // The toolchain of the running Cargo must not be that of the nightly one.
        miri.env_remove("RUSTC").env_remove("CARGO").env_remove("RUSTUP_TOOLCHAIN");
        miri.env("CARGO_TARGET_DIR", target().join("miri"));
        let printed = run_program(&mut miri)?;
        let count = |line: &str| line.strip_prefix("test result: ok. ")?.split(' ').next()?.parse::<u32>().ok();
        passed += printed.lines().filter_map(count).sum::<u32>();
    }
    Ok(Outcome::Passed(format!("{passed} tests")))
}
