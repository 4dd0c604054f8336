//! Compilers for other targets than this machine.

use crate::{
    Result,
    process::{cargo, program, run, target},
    setup::{DEBIAN_COMPILER, Need, debian},
};
use std::{path::Path, process::Command};

/// Source of the standard library for a target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Compiler {
    /// Prebuilt, from rustup.
    Rustup,
    /// Built from source by Debian's compiler, if rustup's server cannot be reached.
    Debian,
}

impl Compiler {
    /// Installs what is needed to compile for the targets.
    pub fn install(targets: &[&'static str]) -> Result<Self> {
        if targets.iter().all(|triple| Need::Target(triple).install().is_ok()) {
            return Ok(Self::Rustup);
        }
        debian(&[DEBIAN_COMPILER])?;
        Ok(Self::Debian)
    }

    /// `cargo` with a standard library that is compiled for the flags of the command, as shared memory needs it. Rustup's must
    /// have its source, see [`Need::LibrarySource`].
    pub fn cargo_with_library(self, arguments: &str, triple: &str, library: &str) -> Result<Command> {
        if self == Self::Debian {
            return self.cargo(arguments, triple, library);
        }
        let mut command = cargo(&format!("{arguments} -Zbuild-std={library} --target {triple}"));
        // Building the standard library is not stable. The compiler stays the one that builds everything else.
        command.env("RUSTC_BOOTSTRAP", "1");
        Ok(command)
    }

    /// A Cargo command for a target. `library` lists the parts of the standard library that it needs.
    pub fn cargo(self, arguments: &str, triple: &str, library: &str) -> Result<Command> {
        if self == Self::Rustup {
            return Ok(cargo(&format!("{arguments} --target {triple}")));
        }
        let mut command = program("/usr/bin/cargo", &format!("{arguments} -Zbuild-std={library} --target {triple}"));
        command.env("RUSTC_BOOTSTRAP", "1").env("RUSTC", "/usr/bin/rustc").env_remove("RUSTUP_TOOLCHAIN");
        if triple.starts_with("wasm32") {
            // Debian's compiler does not include the linker, but rustup's does.
            let (sysroot, host) = (run(&mut program("rustc", "--print sysroot"))?, host()?);
            let linker = Path::new(sysroot.trim()).join("lib/rustlib").join(host).join("bin/rust-lld");
            let variable = triple.to_uppercase().replace('-', "_");
            command.env(format!("CARGO_TARGET_{variable}_LINKER"), linker);
        }
        // Two compilers in one folder would rebuild everything at every change between them.
        command.env("CARGO_TARGET_DIR", target().join("debian"));
        Ok(command)
    }
}

fn host() -> Result<String> {
    Ok(run(&mut program("rustc", "--print host-tuple"))?.trim().to_owned())
}
