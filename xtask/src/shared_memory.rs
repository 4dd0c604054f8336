//! The build of the npm package's reconstruction for several threads, which are workers that share its memory.
//!
//! It differs from the other builds in its standard library, which must be compiled for shared memory, too, and in its
//! JavaScript, which must not decode text in shared memory directly.

use crate::{
    Result,
    compiler::Compiler,
    process::{root, run, target},
    setup::Need,
    steps::Outcome,
    wasm_module::{INLINE, SMALL, TRIPLE, bind, copy, gzip, places, read},
};
use std::path::Path;

/// Name of its files in the package.
pub const FILE: &str = "pcmvs-threads";
/// Maximum size, compressed, in bytes.
const BUDGET: usize = 416 << 10;
/// Shared memory needs atomic instructions, a declared maximum, and storage per thread that each worker initialises. The
/// maximum is that of the other builds: all that 32 bits address.
const FLAGS: [&str; 8] = [
    "-Ctarget-feature=+simd128,+atomics,+bulk-memory,+mutable-globals",
    "-Clink-arg=--shared-memory",
    "-Clink-arg=--import-memory",
    "-Clink-arg=--max-memory=4294967296",
    "-Clink-arg=--export=__wasm_init_tls",
    "-Clink-arg=--export=__tls_size",
    "-Clink-arg=--export=__tls_align",
    "-Clink-arg=--export=__tls_base",
];

/// Whether the package in `wasm/pkg` has it.
pub fn is_built() -> bool {
    root().join("wasm/pkg").join(format!("{FILE}.wasm")).exists()
}

/// Installs what the build needs. Without it, the package goes without the module.
pub fn prepare() -> Outcome {
    match Need::LibrarySource.install() {
        Ok(()) => Outcome::Passed(String::new()),
        Err(_) => Outcome::Skipped(format!("the npm package goes without it: {}", Need::LibrarySource.remedy())),
    }
}

/// Builds it and adds it to the package, if this machine can; returns its size.
pub fn add(compiler: Compiler, package: &Path) -> Result<String> {
    if !Need::LibrarySource.is_met() {
        return Ok(format!("no module with threads: {}", Need::LibrarySource.remedy()));
    }
    let target = target().join("wasm-threads");
    let arguments = "rustc --profile wasm --package pcmvs-wasm --no-default-features --features threads";
    let mut build = compiler.cargo_with_library(arguments, TRIPLE, "std,panic_abort")?;
    let places = places()?;
    let flags: Vec<&str> = FLAGS.into_iter().chain([INLINE]).chain(places.iter().map(String::as_str)).collect();
    let flags = flags.join("\u{1f}");
    build.arg("--").args(SMALL);
    run(build.env("CARGO_TARGET_DIR", &target).env("CARGO_ENCODED_RUSTFLAGS", flags))?;
    let bound = target.join("bound");
    bind(&target, &bound, FILE)?;
    for file in [format!("{FILE}.js"), format!("{FILE}.d.ts")] {
        copy(&bound.join(&file), &package.join(&file))?;
    }
    let wasm = package.join(format!("{FILE}.wasm"));
    copy(&bound.join(format!("{FILE}_bg.wasm")), &wasm)?;
    let compressed = gzip(&read(&wasm)?)?.len();
    if compressed > BUDGET {
        return Err(format!("{}: {compressed} bytes compressed of {BUDGET} allowed", wasm.display()));
    }
    Ok(format!("threads {} KiB compressed of {} allowed", compressed >> 10, BUDGET >> 10))
}
