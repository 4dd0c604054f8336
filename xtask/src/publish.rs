//! What is published: four crates and an npm package.

use crate::{
    Result,
    process::{cargo, program, root, run},
    shared_memory,
    steps::{Outcome, Steps, passed},
};
use serde_json::Value;

/// In the order in which they depend on each other.
const CRATES: [&str; 4] = ["pcmvs-core", "pcmvs-scene", "pcmvs-cli", "pcmvs-ffi"];
/// What every crate's archive has.
const NEEDED: [&str; 3] = ["Cargo.toml", "README.md", "src/lib.rs"];
/// Folders of a crate that are for its developers.
const OURS: [&str; 3] = ["tests/", "benches/", "abi/"];
/// What the npm package has. It needs no others. On a machine that cannot build the module with threads, it goes without.
const NPM: [&str; 37] = [
    "LICENSE-three",
    "README.md",
    "calibration.d.ts",
    "calibration.js",
    "element.d.ts",
    "element.js",
    "forms.d.ts",
    "forms.js",
    "index.d.ts",
    "index.js",
    "load.js",
    "package.json",
    "pcmvs-calibration.d.ts",
    "pcmvs-calibration.js",
    "pcmvs-calibration.scalar.wasm",
    "pcmvs-calibration.simd.wasm",
    "pcmvs-forms.d.ts",
    "pcmvs-forms.js",
    "pcmvs-forms.scalar.wasm",
    "pcmvs-forms.simd.wasm",
    "pcmvs-scene.d.ts",
    "pcmvs-scene.js",
    "pcmvs-scene.scalar.wasm",
    "pcmvs-threads.d.ts",
    "pcmvs-threads.js",
    "pcmvs-threads.wasm",
    "pcmvs.d.ts",
    "pcmvs.js",
    "pcmvs.scalar.wasm",
    "pcmvs.simd.wasm",
    "player.d.ts",
    "player.js",
    "scene.d.ts",
    "scene.js",
    "thread.js",
    "threads.d.ts",
    "threads.js",
];

/// Checks the contents of all archives; with `all`, that crates.io would take the crates as far as Cargo can tell.
pub fn check(steps: &mut Steps, all: bool) -> Result<()> {
    steps.step("contents of the crates", || CRATES.into_iter().try_for_each(contents).map(passed))?;
    if all {
        steps.step("cargo publish --dry-run", || {
            let mut publish = cargo("publish --quiet --dry-run --allow-dirty");
            CRATES.iter().for_each(|name| _ = publish.args(["--package", name]));
            run(&mut publish).map(passed)
        })?;
    }
    if !root().join("wasm/pkg/package.json").exists() {
        return steps.step("npm pack --dry-run", || {
            Ok(Outcome::Skipped(String::from("wasm/pkg is missing: cargo xtask wasm")))
        });
    }
    steps.step("npm pack --dry-run", || npm().map(Outcome::Passed))
}

/// A crate's archive has what it needs, and nothing that only its developers need.
fn contents(name: &str) -> Result<()> {
    let list = run(cargo("package --list --allow-dirty --package").arg(name))?;
    if let Some(missing) = NEEDED.iter().find(|file| !list.lines().any(|line| line == **file)) {
        return Err(format!("{name}: {missing} is not in its archive: correct `include` in its Cargo.toml"));
    }
    match list.lines().find(|line| OURS.iter().any(|folder| line.starts_with(folder))) {
        Some(file) => Err(format!("{name}: {file} is in its archive: correct `include` in its Cargo.toml")),
        None => Ok(()),
    }
}

/// The npm package has its files and no others; returns its size.
fn npm() -> Result<String> {
    let printed = run(program("npm", "pack --dry-run --json").current_dir(root().join("wasm/pkg")))?;
    let packed: Value = serde_json::from_str(&printed).map_err(|e| format!("npm pack: {e}"))?;
    let files = packed[0]["files"].as_array().into_iter().flatten().filter_map(|file| file["path"].as_str());
    let mut files: Vec<&str> = files.collect();
    files.sort_unstable();
    let mut expected = NPM.to_vec();
    if !shared_memory::is_built() {
        expected.retain(|file| !file.starts_with(shared_memory::FILE));
    }
    if files != expected {
        return Err(format!("wasm/pkg: npm would pack {files:?}, not {expected:?}"));
    }
    Ok(format!("{} KiB", packed[0]["size"].as_u64().unwrap_or(0) >> 10))
}
