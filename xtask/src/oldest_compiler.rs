//! The oldest compiler that Cargo.toml claims (`rust-version`) builds what others embed.

use crate::{
    Result,
    process::{cargo_environment, program, run},
    steps::Outcome,
};

/// The claim.
const VERSION: &str = env!("CARGO_PKG_RUST_VERSION");

/// Checks the published crates with that compiler, which is installed if rustup can.
pub fn check() -> Result<Outcome> {
    if run(&mut program("rustup", "--version")).is_err() {
        return Ok(Outcome::Skipped(String::from("needs rustup")));
    }
    let arguments = format!("toolchain install {VERSION} --profile minimal --no-self-update");
    if run(&mut program("rustup", &format!("run {VERSION} cargo --version"))).is_err()
        && run(&mut program("rustup", &arguments)).is_err()
    {
        return Ok(Outcome::Skipped(format!("needs Rust {VERSION}: `rustup {arguments}` failed")));
    }
    let crates = "-p pcmvs-core -p pcmvs-ffi -p pcmvs-scene -p pcmvs-cli";
    let mut check = program("rustup", &format!("run {VERSION} cargo check --quiet {crates} --all-features"));
    run(cargo_environment(&mut check))?;
    Ok(Outcome::Passed(format!("Rust {VERSION}")))
}
