//! `cargo xtask test`: all checks, quick ones first.

use crate::{
    Result, abi_check, blender, captured, cycles, farm, fuzz, golden, miri, no_std, oldest_compiler, players,
    process::{cargo, program, root, run as run_program, target},
    publish, python,
    setup::Need,
    steps::{Outcome, Steps, passed},
    supply, web, windows,
};
use std::{fs, path::PathBuf};

/// A minimal toolchain has neither of them.
const RUSTFMT: Need = Need::Component("rustfmt", "fmt --version");
const CLIPPY: Need = Need::Component("clippy", "clippy --version");
/// For the glTF validator.
const VALIDATOR: Need = Need::Npm("tests/gltf");
/// Decodes videos. The tests of videos are skipped without it.
const FFMPEG: Need = Need::Debian(("ffmpeg", "/usr/bin/ffmpeg"));

/// What the checks need besides the toolchain.
fn needs(all: bool) -> Vec<Need> {
    let mut needs = vec![RUSTFMT, CLIPPY, VALIDATOR];
    needs.extend(no_std::NEEDS);
    needs.extend(oldest_compiler::NEEDS);
    needs.extend(golden::needs(all));
    needs.extend(web::NEEDS);
    needs.push(Need::LibrarySource);
    needs.extend(python::NEEDS);
    if all {
        needs.push(FFMPEG);
        needs.extend(players::NEEDS);
        needs.extend(blender::NEEDS);
        needs.extend(farm::NEEDS);
        needs.extend(abi_check::NEEDS);
        needs.extend(fuzz::NEEDS);
        needs.extend(miri::NEEDS);
        needs.extend(supply::NEEDS);
        needs.extend(windows::needs());
    }
    needs
}

/// Makes all checks; with `all`, including the long ones. With `install`, checks install what they need.
pub fn run(all: bool, install: bool) -> Result<()> {
    let mut steps = Steps::new(install);
    steps.announce(&needs(all));
    steps.step_with(&[RUSTFMT, CLIPPY], "toolchain", || {
        [RUSTFMT, CLIPPY].iter().try_for_each(|need| need.install()).map(passed)
    })?;
    steps.step_with(&[RUSTFMT], "format", || run_program(&mut cargo("fmt --all --check")).map(passed))?;
    steps.step_with(&[CLIPPY], "lints", || lints().map(passed))?;
    steps.step_with(&[web::LINTERS], "JavaScript and TypeScript", || web::lints().map(passed))?;
    steps.step("module cycles", || cycles::check().map(Outcome::Passed))?;
    steps.step_with(&no_std::NEEDS, "core without std", || no_std::check().map(Outcome::Passed))?;
    steps.step_with(&oldest_compiler::NEEDS, "oldest compiler", oldest_compiler::check)?;
    steps.step("tests", || tests(all).map(Outcome::Passed))?;
    golden::check(&mut steps, all)?;
    steps.step("documentation", || {
        let mut doc = cargo("doc --quiet --workspace --no-deps --all-features");
        run_program(doc.env("RUSTDOCFLAGS", "-D warnings")).map(passed)
    })?;
    steps.step("from pictures to meshes", || pipeline().map(Outcome::Passed))?;
    steps.step_with(&[VALIDATOR], "Khronos glTF validator", || validator().map(Outcome::Passed))?;
    web::check(&mut steps, all)?;
    python::check(&mut steps)?;
    publish::check(&mut steps, all)?;
    if all {
        steps.step_with(&[FFMPEG], "videos", || {
            FFMPEG.install()?;
            run_program(cargo("test --package pcmvs-cli video").env("PCMVS_ALL_TOOLS", "1")).map(passed)
        })?;
        players::check(&mut steps)?;
        blender::check(&mut steps)?;
        farm::check(&mut steps)?;
        abi_check::check(&mut steps)?;
        windows::check(&mut steps)?;
        steps.step_with(&fuzz::NEEDS, "fuzzing", fuzz::check)?;
        steps.step_with(&miri::NEEDS, "Miri", miri::check)?;
        supply::check(&mut steps)?;
        captured::check(&mut steps)?;
    }
    steps.finish();
    Ok(())
}

/// Makes only the long checks of the C library.
pub fn c_library() -> Result<()> {
    Steps::alone(&abi_check::NEEDS, abi_check::check)
}

/// Lints of the workspace, and of the fuzz targets, which are a workspace of their own with dependencies in common.
fn lints() -> Result<()> {
    run_program(&mut cargo("clippy --quiet --workspace --all-targets --all-features -- -D warnings"))?;
    let mut fuzz = cargo("clippy --quiet --manifest-path tests/fuzz/Cargo.toml --no-default-features --target-dir");
    run_program(fuzz.arg(target()).args(["--", "-D", "warnings"])).map(drop)
}

/// All Rust tests, including those of the C library. Those that take long are marked `ignore`, and only run with `all`; the C
/// library's are run by [`abi_check`]. Reports how many passed, and which were skipped.
fn tests(all: bool) -> Result<String> {
    // The tasks alone, because with the features of the workspace all that they depend on would be compiled again.
    let mut printed = run_program(&mut cargo("test --workspace --exclude xtask --all-features"))?
        + &run_program(&mut cargo("test --package xtask"))?;
    if all {
        printed +=
            &run_program(&mut cargo("test --workspace --exclude xtask --all-features --test facts -- --ignored"))?;
    }
    let count = |line: &str| {
        let passed = line.strip_prefix("test result: ok. ")?.split(' ').next()?;
        passed.parse::<u32>().ok()
    };
    let total: u32 = printed.lines().filter_map(count).sum();
    let skipped = printed.lines().filter_map(|line| Some(&line[line.find("SKIPPED: ")?..]));
    Ok(skipped.fold(format!("{total} tests"), |text, line| format!("{text}\n  {line}")))
}

fn smoke() -> PathBuf {
    target().join("smoke")
}

/// A small version of the demo: pictures from the studio, meshes with every preset.
fn pipeline() -> Result<String> {
    // The tests have built these commands.
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
    for (name, options) in FORMS {
        let mut reconstruct = program(binary("pcmvs"), &format!("reconstruct --frames 0 {options} -o"));
        run_program(reconstruct.arg(smoke().join(name)).arg(&scene))?;
    }
    for (name, clip, options) in PACKED {
        let mut pack = program(binary("pcmvs"), &format!("pack {options} -o"));
        run_program(pack.arg(smoke().join(name)).arg(smoke().join(clip)))?;
    }
    let quality = format!("pack --manifest --quality mobile={} -o", smoke().join("mobile").display());
    run_program(program(binary("pcmvs"), &quality).arg(smoke().join("published")).arg(smoke().join("web")))?;
    let sheet = smoke().join("look.png");
    let mesh = smoke().join("default/frame_0000.glb");
    run_program(program(binary("look"), "").arg(&scene).arg(mesh).args(["--cameras", "0,4,8", "-o"]).arg(sheet))?;
    Ok(format!("{} presets, 2 frames, {} other forms, {} packed clips", PRESETS.len(), FORMS.len(), PACKED.len()))
}

const PRESETS: [&str; 4] = ["hull", "paper", "default", "preview"];

/// Forms of a mesh that the command writes, and the options that ask for them.
const FORMS: [(&str, &str); 6] = [
    ("textured", "--texture"),
    ("textured-upright", "--texture --upright"),
    ("compressed", "--compress --upright"),
    ("upright", "--upright"),
    ("web", "--faces 2000 --texture=256 --compress --upright"),
    ("mobile", "--faces 500 --texture=128 --compress --upright"),
];

/// Clips in one file: names, the folders of their frames, and options of `pcmvs pack`.
const PACKED: [(&str, &str, &str); 3] = [
    ("packed.glb", "default", ""),
    ("packed-visibility.glb", "default", "--visibility"),
    ("packed-web.glb", "web", ""),
];

/// Files of a published clip, whose qualities are the forms web and mobile.
const PUBLISHED: [&str; 2] = ["published/full.glb", "published/mobile.glb"];

fn validator() -> Result<String> {
    let folder = root().join("tests/gltf");
    VALIDATOR.install()?;
    let frames = PRESETS.iter().flat_map(|p| [0, 1].map(|i| smoke().join(format!("{p}/frame_{i:04}.glb"))));
    let forms = FORMS.iter().map(|(name, _)| smoke().join(name).join("frame_0000.glb"));
    let packed = PACKED.iter().map(|(name, ..)| *name).chain(PUBLISHED).map(|name| smoke().join(name));
    let frames: Vec<PathBuf> = frames.chain(forms).chain(packed).collect();
    run_program(program("node", "validate.mjs").args(&frames).current_dir(&folder))?;
    Ok(format!("{} files", frames.len()))
}
