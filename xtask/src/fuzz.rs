//! `cargo xtask fuzz`: runs the fuzz targets of tests/fuzz with libFuzzer and AddressSanitizer.

use crate::{
    Result,
    process::{program, root, run as run_program, show, target},
    setup::Need,
    steps::Outcome,
};
use std::{fs, path::PathBuf};

/// Sanitizers are in nightly compilers only. Without one the check is skipped.
pub const NEEDS: [Need; 1] = [Need::Toolchain("nightly")];

/// The targets, in the order in which they run.
const TARGETS: [&str; 6] = ["scene", "import", "clip", "picture", "calls", "reconstruct"];
/// Those that run commands, whose output is of no use here. An input that fails shows it if it is run alone.
const PRINTING: [&str; 1] = ["clip"];
/// Seconds of each target in the checks.
const SECONDS: u32 = 20;
/// The machine that the sanitizer is built for.
const TRIPLE: &str = "x86_64-unknown-linux-gnu";

/// What cargo-fuzz passes, too: counters of edges, comparisons for the fuzzer to solve, and the sanitizer.
const FLAGS: &str = "--cfg fuzzing -Zsanitizer=address -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
                     -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
                     -Cllvm-args=-sanitizer-coverage-trace-compares";

fn built() -> PathBuf {
    target().join("fuzz")
}

/// Builds the targets and returns their folder.
fn build() -> Result<PathBuf> {
    let arguments =
        format!("run nightly cargo build --quiet --release --manifest-path tests/fuzz/Cargo.toml --target {TRIPLE}");
    let mut build = program("rustup", &arguments);
    // The toolchain of the running Cargo must not be that of the nightly one.
    build.env_remove("RUSTC").env_remove("CARGO").env_remove("RUSTUP_TOOLCHAIN");
    run_program(build.env("RUSTFLAGS", FLAGS).env("CARGO_TARGET_DIR", built()))?;
    Ok(built().join(TRIPLE).join("release"))
}

/// Runs one target. New inputs stay in its corpus below the target folder, and an input that fails is kept beside it.
fn command(folder: &std::path::Path, name: &str, seconds: u32) -> Result<std::process::Command> {
    let corpus = built().join("corpus").join(name);
    fs::create_dir_all(&corpus).map_err(|e| format!("{}: {e}", corpus.display()))?;
    let limits = format!("-max_total_time={seconds} -timeout=10 -rss_limit_mb=2048 -max_len=4096 -print_final_stats=1");
    let mut fuzz = program(folder.join(name), &limits);
    if PRINTING.contains(&name) {
        fuzz.arg("-close_fd_mask=3");
    }
    fuzz.arg(format!("-artifact_prefix={}/failed-{name}-", built().display()));
    fuzz.arg(corpus).arg(root().join("tests/fuzz/seeds").join(name));
    Ok(fuzz)
}

/// Fuzzes each target for so many seconds and shows what libFuzzer says.
pub fn run(seconds: u32, only: Option<&str>) -> Result<()> {
    if let Some(need) = NEEDS.iter().find(|need| !need.is_met()) {
        println!("SKIPPED: fuzzing needs a nightly compiler: {}", need.remedy());
        return Ok(());
    }
    let folder = build()?;
    TARGETS.iter().filter(|&&name| only.is_none_or(|only| only == name)).try_for_each(|name| {
        println!("{name}");
        show(&mut command(&folder, name, seconds)?)
    })
}

/// The check: a short run of each target.
pub fn check() -> Result<Outcome> {
    let folder = build()?;
    TARGETS.iter().try_for_each(|name| run_program(&mut command(&folder, name, SECONDS)?).map(drop))?;
    Ok(Outcome::Passed(format!("{} targets, {SECONDS} s each", TARGETS.len())))
}
