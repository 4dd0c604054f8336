//! What all builds of the npm package's modules have in common.

use crate::{
    Result,
    process::{program, run},
};
use flate2::{Compression, write::GzEncoder};
use std::{
    env, fs,
    io::Write,
    path::{Path, PathBuf},
};
use wasm_bindgen_cli_support::Bindgen;

/// Inlines little, which keeps the modules within their budgets. Hot loops are inlined by attribute.
pub const INLINE: &str = "-Cllvm-args=-inline-threshold=15";
/// Flags of the optimisation across crates only, for the same end: loops are not unrolled any further, addresses are reckoned
/// where they are used, loops of fewer than 32 steps are not vectorised, and code is not repeated to save a read of memory.
/// Earlier, short loops must be unrolled, or matching takes twice as long.
pub const SMALL: [&str; 5] = [
    "-Cllvm-args=-unroll-threshold=0",
    "-Cllvm-args=-unroll-runtime=false",
    "-Cllvm-args=-disable-lsr",
    "-Cllvm-args=-vectorizer-min-trip-count=32",
    "-Cllvm-args=-enable-load-pre=false",
];
/// The compiler's flags by which the places that messages of defects name, in dependencies and in the standard library, do not
/// depend on this machine.
pub fn places() -> Result<Vec<String>> {
    let home = env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| env::home_dir().map(|home| home.join(".cargo"))).unwrap_or_default();
    let toolchain = run(&mut program("rustc", "--print sysroot"))?;
    let folders = [home.join("registry/src/"), Path::new(toolchain.trim()).join("lib/rustlib/src/rust/")];
    Ok(folders.iter().map(|folder| format!("--remap-path-prefix={}=", folder.display())).collect())
}

/// The browser.
pub const TRIPLE: &str = "wasm32-unknown-unknown";

/// Makes a module and its JavaScript in the folder `bound` of what Cargo has built in `target`.
pub fn bind(target: &Path, bound: &Path, file: &str) -> Result<()> {
    let made =
        Bindgen::new().input_path(target.join(TRIPLE).join("wasm/pcmvs_wasm.wasm")).out_name(file).web(true).and_then(
            |bindgen| {
                let bindgen = bindgen.typescript(true).omit_default_module_path(true);
                bindgen.remove_name_section(true).remove_producers_section(true).generate(bound)
            },
        );
    made.map_err(|e| format!("wasm-bindgen: {file}: {e:#}"))
}

pub fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

pub fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).map(drop).map_err(|e| format!("{} to {}: {e}", from.display(), to.display()))
}

pub fn gzip(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|e| e.to_string())
}
