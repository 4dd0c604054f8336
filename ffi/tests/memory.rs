//! Nothing leaks, nothing is read that is not there, memory stays steady.

mod common;

use common::{C99, Link, Sample, build, has, output, root, run};
use std::process::Command;

#[test]
fn memory_is_steady_over_200_frames() {
    let sample = Sample::sized(6, 80, 60);
    let program = build(sample.path(), C99, "tests/c/soak.c", Link::Shared);
    output(&program, [sample.plain().into_os_string(), "200".into(), "1".into()]);
}

#[test]
fn every_frame_allocates_the_same_and_reading_nothing() {
    if !cfg!(target_env = "gnu") {
        return;
    }
    let sample = Sample::sized(4, 40, 32);
    let program = build(sample.path(), C99, "tests/c/allocations.c", Link::Shared);
    println!("{}", output(&program, [sample.plain().into_os_string(), "12".into()]));
}

#[test]
fn address_sanitizer_finds_no_leak_over_200_frames() {
    let sample = Sample::sized(6, 80, 60);
    let sanitized = ["cc", "-std=c99", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let program = build(sample.path(), &sanitized, "tests/c/soak.c", Link::Shared);
    run(Command::new(program).arg(sample.plain()).args(["200", "0"]).env("ASAN_OPTIONS", "detect_leaks=1"));
    // All misuse, but for reading freed handles.
    let careful = [&sanitized[..], &["-DWITHOUT_FREED_HANDLES"]].concat();
    for source in ["tests/c/misuse.c", "tests/c/results.c"] {
        let program = build(sample.path(), &careful, source, Link::Static);
        run(Command::new(program).arg(sample.plain()).env("ASAN_OPTIONS", "detect_leaks=1"));
    }
}

#[test]
fn valgrind_finds_no_error() {
    valgrind("4");
}

#[test]
#[ignore = "takes minutes: `cargo xtask test --all` runs it"]
fn valgrind_finds_no_error_over_200_frames() {
    valgrind("200");
}

/// Frames of all presets in turn through one rig. What is wrong ends the program with a status of its own.
fn valgrind(frames: &str) {
    if !has("valgrind") {
        return;
    }
    let sample = Sample::sized(4, 40, 32);
    let program = build(sample.path(), C99, "tests/c/soak.c", Link::Shared);
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--leak-check=full", "--show-leak-kinds=all"]);
    valgrind.args(["--errors-for-leak-kinds=all", "--error-exitcode=9"]);
    run(valgrind.current_dir(root()).arg(program).arg(sample.plain()).args([frames, "0"]));
}
