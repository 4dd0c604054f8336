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
    if !has("valgrind") {
        return;
    }
    let sample = Sample::sized(5, 64, 48);
    let program = build(sample.path(), C99, "tests/c/soak.c", Link::Shared);
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--quiet", "--leak-check=full", "--show-leak-kinds=definite,indirect,possible"]);
    valgrind.args(["--errors-for-leak-kinds=definite,indirect,possible", "--error-exitcode=9"]);
    run(valgrind.current_dir(root()).arg(program).arg(sample.plain()).args(["4", "0"]));
}
