//! Checks that the core compiles for targets without std.

use crate::{Result, compiler::Compiler, process::run, setup::Need};

/// WebAssembly without a host, and a microcontroller with single-precision floats.
const TARGETS: [&str; 2] = ["wasm32v1-none", "thumbv7em-none-eabihf"];

pub const NEEDS: [Need; 2] = [Need::TargetOrDebian(TARGETS[0]), Need::TargetOrDebian(TARGETS[1])];

/// Checks the core for both targets. Returns how they were compiled.
pub fn check() -> Result<String> {
    let compiler = Compiler::install(&TARGETS)?;
    for target in TARGETS {
        run(&mut compiler.cargo("check --package pcmvs-core --all-features", target, "core,alloc")?)?;
    }
    Ok(String::from(match compiler {
        Compiler::Rustup => "with rustup's targets",
        Compiler::Debian => "with core and alloc built from Debian's rust-web-src",
    }))
}
