//! Nothing leaks, no invalid memory is read, and memory use stays steady.

mod common;

use common::{C99, Link, Sample, build, has, output, root, run};
use std::process::Command;

const SANITIZED: &[&str] = &["cc", "-std=c99", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];

/// Of so many allocations one is made to fail, so that the test stays quick. `PCMVS_STARVED_STEP=1` makes each fail in its
/// turn.
const STARVED_STEP: &str = "997";
/// The same under AddressSanitizer.
const STARVED_STEP_SANITIZED: &str = "4999";

#[test]
fn memory_is_steady_over_200_frames() {
    let sample = Sample::sized(6, 80, 60);
    let program = build(sample.path(), C99, "tests/c/soak.c", Link::Shared);
    output(&program, [sample.plain().into_os_string(), "200".into(), "1".into()]);
}

#[test]
fn later_frames_allocate_little_and_equally_and_reading_hardly_allocates() {
    if !cfg!(target_env = "gnu") {
        return;
    }
    let sample = Sample::sized(4, 80, 60);
    let program = build(sample.path(), C99, "tests/c/allocations.c", Link::Shared);
    println!("{}", output(&program, [sample.plain().into_os_string(), "12".into()]));
}

#[test]
fn the_callers_allocator_serves_everything() {
    let sample = Sample::sized(4, 40, 32);
    let glb = |name: &str| sample.path().join(name);
    let whole = build(sample.path(), C99, "examples/c/reconstruct.c", Link::Shared);
    output(&whole, [sample.plain(), glb("whole.glb")]);
    let expected = std::fs::read(glb("whole.glb")).unwrap();
    let counted = [C99, &["-DCOUNT_MALLOC"]].concat();
    let plain = if cfg!(target_env = "gnu") { &counted[..] } else { C99 };
    for (compiler, link) in [(plain, Link::Shared), (plain, Link::Static), (SANITIZED, Link::Static)] {
        let program = build(sample.path(), compiler, "tests/c/allocator.c", link);
        for growing in ["growing", "copied"] {
            output(&program, [sample.plain(), glb("own.glb"), growing.into()]);
            assert!(std::fs::read(glb("own.glb")).unwrap() == expected, "the allocator changes the bytes");
        }
    }
    if has("valgrind") {
        let program = build(sample.path(), C99, "tests/c/allocator.c", Link::Shared);
        run(under_valgrind().arg(program).arg(sample.plain()).arg(glb("own.glb")).arg("growing"));
    }
}

#[test]
fn a_failure_of_the_callers_allocator_is_a_status() {
    let sample = Sample::sized(4, 40, 32);
    let wanted = std::env::var("PCMVS_STARVED_STEP").ok();
    let step = |usual: &str| wanted.clone().unwrap_or_else(|| usual.to_owned());
    let program = build(sample.path(), C99, "tests/c/starved.c", Link::Shared);
    println!("{}", output(&program, [sample.plain(), step(STARVED_STEP).into()]));
    let program = build(sample.path(), SANITIZED, "tests/c/starved.c", Link::Static);
    run(Command::new(program)
        .arg(sample.plain())
        .arg(step(STARVED_STEP_SANITIZED))
        .env("ASAN_OPTIONS", "detect_leaks=1"));
}

#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn address_sanitizer_finds_no_leak_over_200_frames() {
    let sample = Sample::sized(6, 80, 60);
    let program = build(sample.path(), SANITIZED, "tests/c/soak.c", Link::Shared);
    run(Command::new(program).arg(sample.plain()).args(["200", "0"]).env("ASAN_OPTIONS", "detect_leaks=1"));
    let careful = [SANITIZED, &["-DFEW_CALLS"]].concat();
    for source in ["tests/c/misuse.c", "tests/c/results.c", "tests/c/warnings.c"] {
        let program = build(sample.path(), &careful, source, Link::Static);
        run(Command::new(program).arg(sample.plain()).env("ASAN_OPTIONS", "detect_leaks=1"));
    }
    let tiny = Sample::sized(4, 40, 32);
    let program = build(tiny.path(), SANITIZED, "tests/c/hostile.c", Link::Static);
    run(Command::new(program).arg(tiny.plain()).args(["4", "300"]).env("ASAN_OPTIONS", "detect_leaks=1"));
    let program = build(tiny.path(), &[SANITIZED, &["-pthread"]].concat(), "tests/c/early.c", Link::Static);
    run(Command::new(program).arg(tiny.plain()).env("ASAN_OPTIONS", "detect_leaks=1"));
    let turned = Sample::turned();
    let program = build(turned.path(), SANITIZED, "tests/c/calibration.c", Link::Static);
    run(Command::new(program).arg(turned.plain()).env("ASAN_OPTIONS", "detect_leaks=1"));
}

#[test]
fn valgrind_finds_no_error() {
    valgrind("4");
}

#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn valgrind_finds_no_error_over_200_frames() {
    valgrind("200");
}

/// Reconstructs frames with all presets in turn.
fn valgrind(frames: &str) {
    if !has("valgrind") {
        return;
    }
    let sample = Sample::sized(4, 40, 32);
    let program = build(sample.path(), C99, "tests/c/soak.c", Link::Shared);
    run(under_valgrind().arg(program).arg(sample.plain()).args([frames, "0"]));
}

/// Valgrind with an exit status of its own for errors and leaks.
fn under_valgrind() -> Command {
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--leak-check=full", "--show-leak-kinds=all"]);
    valgrind.args(["--errors-for-leak-kinds=all", "--error-exitcode=9"]).current_dir(root());
    valgrind
}
