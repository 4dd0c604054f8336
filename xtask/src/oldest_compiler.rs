//! The oldest compiler that Cargo.toml claims (`rust-version`) builds what others embed.

use crate::{
    Result,
    process::{cargo_environment, program, run},
    setup::Need,
    steps::Outcome,
};

/// The claim.
const VERSION: &str = env!("CARGO_PKG_RUST_VERSION");

pub const NEEDS: [Need; 1] = [Need::Toolchain(VERSION)];

/// Checks the published crates with that compiler; skipped where rustup cannot install it.
pub fn check() -> Result<Outcome> {
    if let Err(why) = NEEDS[0].install() {
        return Ok(Outcome::Skipped(format!("needs Rust {VERSION}: {why}")));
    }
    let crates = "-p pcmvs-core -p pcmvs-ffi -p pcmvs-scene -p pcmvs-cli";
    let mut check = program("rustup", &format!("run {VERSION} cargo check --quiet {crates} --all-features"));
    run(cargo_environment(&mut check))?;
    Ok(Outcome::Passed(format!("Rust {VERSION}")))
}
