//! The core on targets without an operating system: whoever uses std in it is told here.

use crate::{
    Result,
    process::{cargo, program, run, target},
};
use std::path::Path;

/// WebAssembly without any host, and a microcontroller with single-precision floats.
const TARGETS: [&str; 2] = ["wasm32v1-none", "thumbv7em-none-eabihf"];

/// Checks the core for both targets. Says how it was done.
pub fn check() -> Result<String> {
    let installed = run(&mut program("rustup", "target list --installed")).unwrap_or_default();
    let missing: Vec<&str> = TARGETS.into_iter().filter(|t| !installed.lines().any(|line| line == *t)).collect();
    if missing.is_empty() || run(program("rustup", "target add").args(&missing)).is_ok() {
        for target in TARGETS {
            run(&mut cargo(&format!("check --package pcmvs-core --all-features --target {target}")))?;
        }
        return Ok(String::from("with rustup's targets"));
    }
    with_system_compiler()?;
    Ok(String::from("with core and alloc built from Debian's rust-web-src"))
}

/// Where rustup's server cannot be reached: Debian's compiler, and the standard library's own sources.
fn with_system_compiler() -> Result<()> {
    if !Path::new("/usr/lib/rustlib/src/rust/library").exists() {
        for arguments in ["update -qq", "install -y -qq --no-install-recommends rustc-web cargo-web rust-web-src"] {
            run(program("apt-get", arguments).env("DEBIAN_FRONTEND", "noninteractive"))?;
        }
    }
    for triple in TARGETS {
        let arguments = format!("check -Zbuild-std=core,alloc --package pcmvs-core --all-features --target {triple}");
        let mut command = program("/usr/bin/cargo", &arguments);
        // A folder of its own: two compilers in one would build everything twice, every time.
        command.env("CARGO_TARGET_DIR", target().join("no-std"));
        run(command.env("RUSTC_BOOTSTRAP", "1").env("RUSTC", "/usr/bin/rustc").env_remove("RUSTUP_TOOLCHAIN"))?;
    }
    Ok(())
}
