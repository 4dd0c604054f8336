//! `cargo xtask test`: all checks, the quick ones first.

use crate::{
    Result, abi_check, captured, golden, no_std, oldest_compiler, players,
    process::{cargo, program, root, run as run_program, target},
    setup,
    steps::{Outcome, Steps, passed},
    web,
};
use std::{fs, path::PathBuf};

/// Sets up what is missing and checks everything; with `all` also what takes long.
pub fn run(all: bool) -> Result<()> {
    let mut steps = Steps::default();
    steps.step("toolchain", || components().map(passed))?;
    steps.step("format", || run_program(&mut cargo("fmt --all --check")).map(passed))?;
    steps.step("lints", || {
        run_program(&mut cargo("clippy --quiet --workspace --all-targets --all-features -- -D warnings")).map(passed)
    })?;
    steps.step("core without std", || no_std::check().map(Outcome::Passed))?;
    steps.step("oldest compiler", oldest_compiler::check)?;
    steps.step("tests", || tests().map(Outcome::Passed))?;
    golden::check(&mut steps, all)?;
    steps.step("documentation", || {
        let mut doc = cargo("doc --quiet --workspace --no-deps --all-features");
        run_program(doc.env("RUSTDOCFLAGS", "-D warnings")).map(passed)
    })?;
    steps.step("from pictures to meshes", || pipeline().map(Outcome::Passed))?;
    steps.step("Khronos glTF validator", || validator().map(Outcome::Passed))?;
    web::check(&mut steps, all)?;
    if all {
        players::check(&mut steps)?;
        abi_check::check(&mut steps)?;
        captured::check(&mut steps)?;
    }
    steps.finish();
    Ok(())
}

/// The long checks of the C library alone.
pub fn c_library() -> Result<()> {
    let mut steps = Steps::default();
    abi_check::check(&mut steps)?;
    steps.finish();
    Ok(())
}

/// A minimal toolchain has neither of them.
fn components() -> Result<()> {
    for (tool, component) in [("fmt", "rustfmt"), ("clippy", "clippy")] {
        if run_program(&mut cargo(&format!("{tool} --version"))).is_err() {
            run_program(&mut program("rustup", &format!("component add {component}")))?;
        }
    }
    Ok(())
}

/// All Rust tests, those of the C library among them; says how many.
fn tests() -> Result<String> {
    let printed = run_program(&mut cargo("test --workspace --all-features"))?;
    let count = |line: &str| {
        let passed = line.strip_prefix("test result: ok. ")?.split(' ').next()?;
        passed.parse::<u32>().ok()
    };
    Ok(format!("{} tests", printed.lines().filter_map(count).sum::<u32>()))
}

fn smoke() -> PathBuf {
    target().join("smoke")
}

/// What the demo does, small: pictures from the studio, meshes by every preset.
fn pipeline() -> Result<String> {
    // The tests have built the commands that they run: nothing is built twice.
    let binary = |name: &str| target().join("debug").join(name);
    if smoke().exists() {
        fs::remove_dir_all(smoke()).map_err(|e| format!("{}: {e}", smoke().display()))?;
    }
    let scene = smoke().join("scene");
    run_program(program(binary("studio"), "--size 160x120 --views 12 --frames 2 --output").arg(&scene))?;
    for preset in PRESETS {
        let out = smoke().join(preset);
        let mut reconstruct = program(binary("pcmvs"), &format!("reconstruct --preset {preset} -o"));
        run_program(reconstruct.arg(&out).arg(&scene))?;
        for file in ["sequence.json", "report.json"] {
            if !out.join(file).exists() {
                return Err(format!("{} is missing", out.join(file).display()));
            }
        }
    }
    let sheet = smoke().join("look.png");
    let mesh = smoke().join("default/frame_0000.glb");
    run_program(program(binary("look"), "").arg(&scene).arg(mesh).args(["--cameras", "0,4,8", "-o"]).arg(sheet))?;
    Ok(format!("{} presets, 2 frames", PRESETS.len()))
}

const PRESETS: [&str; 4] = ["hull", "paper", "default", "preview"];

fn validator() -> Result<String> {
    let folder = root().join("tests/gltf");
    setup::node_packages(&folder)?;
    let frames = PRESETS.iter().flat_map(|p| [0, 1].map(|i| smoke().join(format!("{p}/frame_{i:04}.glb"))));
    let frames: Vec<PathBuf> = frames.collect();
    run_program(program("node", "validate.mjs").args(&frames).current_dir(&folder))?;
    Ok(format!("{} files", frames.len()))
}
