//! `cargo xtask golden`: every build gives the same bytes on every machine (see tests/golden).

use crate::{
    Result,
    process::{cargo, program, root, run, target},
    setup::{CHROMIUM, Need},
    steps::{Outcome, Steps},
    windows,
};
use ::golden::{
    RENEW, Record,
    case::{Case, LARGE, SMALL},
    difference, file,
};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

/// One way to compile and run the program.
struct Build {
    name: &'static str,
    machine: Machine,
    /// Flags of the compiler.
    flags: &'static str,
    /// Setting of Cargo.
    setting: Option<&'static str>,
    /// Runs only with `--all`.
    slow: bool,
}

/// Machine that runs the program.
#[derive(Clone, Copy, PartialEq)]
enum Machine {
    This,
    /// An x86-64 without AVX2. The core uses AVX2 where it is available.
    OldX86,
    Aarch64,
    /// Windows in Wine.
    Windows,
    /// WebAssembly in Node.
    Wasi,
    /// WebAssembly on a page.
    Chromium,
}

/// The published build. The others are compared with it.
const BASELINE: Build = Build { name: "release", machine: Machine::This, flags: "", setting: None, slow: false };

// Slow, because the release build finds AVX2 by itself, and the same code is used.
const AVX2: Build = Build { name: "AVX2", flags: "-Ctarget-feature=+avx2", slow: true, ..BASELINE };

const AVX512: Build = Build { name: "AVX-512", flags: "-Ctarget-cpu=x86-64-v4", slow: true, ..BASELINE };

const SIMD128: &str = "-Ctarget-feature=+simd128";

/// The unoptimised build of `cargo test` has its own test.
const BUILDS: [Build; 11] = [
    AVX2,
    AVX512,
    Build { name: "x86-64 without AVX2", machine: Machine::OldX86, ..BASELINE },
    // Includes fused multiply-add if the processor has it. The compiler must use it only where the source asks for it.
    Build { name: "this processor", flags: "-Ctarget-cpu=native", slow: true, ..BASELINE },
    Build { name: "unoptimised", setting: Some("profile.release.opt-level=0"), slow: true, ..BASELINE },
    Build { name: "WebAssembly", machine: Machine::Wasi, slow: true, ..BASELINE },
    Build { name: "Chromium", machine: Machine::Chromium, slow: true, ..BASELINE },
    Build { name: "WebAssembly SIMD", machine: Machine::Wasi, flags: SIMD128, ..BASELINE },
    Build { name: "Chromium SIMD", machine: Machine::Chromium, flags: SIMD128, ..BASELINE },
    Build { name: "AArch64", machine: Machine::Aarch64, ..BASELINE },
    Build { name: "Windows", machine: Machine::Windows, slow: true, ..BASELINE },
];

const WASI: &str = "wasm32-wasip1";
const AARCH64: &str = "aarch64-unknown-linux-gnu";

const EMULATOR: Need = Need::Debian(("qemu-user", "/usr/bin/qemu-aarch64"));
const LINKER: [Need; 2] = [
    Need::Debian(("gcc-aarch64-linux-gnu", "/usr/bin/aarch64-linux-gnu-gcc")),
    Need::Debian(("libc6-dev-arm64-cross", "/usr/aarch64-linux-gnu/lib/crti.o")),
];
/// For the scripts that run WebAssembly.
const SCRIPTS: [Need; 2] = [Need::Npm("tests/web"), Need::Npm("tests/golden")];

/// What the checks need.
pub fn needs(all: bool) -> Vec<Need> {
    let builds = BUILDS.iter().filter(|build| (all || !build.slow) && build.impossible().is_none());
    builds.flat_map(|build| build.machine.needs()).collect()
}

/// One check per build. With `all`, it includes the slow builds and the large capture.
pub fn check(steps: &mut Steps, all: bool) -> Result<()> {
    let builds: Vec<&Build> = BUILDS.iter().filter(|build| all || !build.slow).collect();
    check_builds(steps, &builds, all)
}

/// Compares the release build with the file, and other builds with it.
fn check_builds(steps: &mut Steps, builds: &[&Build], all: bool) -> Result<()> {
    let cases: Vec<Case> = SMALL.into_iter().chain(all.then_some(LARGE)).collect();
    let mut baseline: Vec<Record> = Vec::new();
    steps.step("golden: release", || {
        cases.iter().try_for_each(write_capture)?;
        let golden = BASELINE.compile()?;
        baseline = cases.iter().map(|case| BASELINE.measure(&golden, case, detail(case))).collect::<Result<_>>()?;
        cases.iter().zip(&baseline).try_for_each(|(case, got)| compare_with_file(case, got))?;
        Ok(Outcome::Passed(counts(&baseline)))
    })?;
    for &build in builds {
        if let Some(why) = build.impossible() {
            steps.step(&format!("golden: {}", build.name), || Ok(Outcome::Skipped(why)))?;
            continue;
        }
        let needs = build.machine.needs();
        steps.step_with(&needs, &format!("golden: {}", build.name), || {
            if let Err(why) = needs.iter().try_for_each(|need| need.install()) {
                return Ok(Outcome::Skipped(why));
            }
            let golden = build.compile()?;
            let mut compared = Vec::new();
            for (case, expected) in cases.iter().zip(&baseline).filter(|(case, _)| **case != LARGE || build.is_quick())
            {
                let got = build.measure(&golden, case, detail(case))?;
                if let Some(difference) = difference(expected, &got) {
                    return Err(format!("{}: {difference}{FIX}", case.name));
                }
                compared.push(case.name);
            }
            Ok(Outcome::Passed(compared.join(", ")))
        })?;
    }
    Ok(())
}

/// All numbers for the small captures. For the large one they would take hundreds of megabytes.
fn detail(case: &Case) -> &'static str {
    if *case == LARGE { "sample" } else { "all" }
}

/// Makes all checks, or those of one build with the small captures.
pub fn run_alone(only: Option<&str>) -> Result<()> {
    let mut steps = Steps::default();
    let Some(name) = only else {
        steps.announce(&needs(true));
        check(&mut steps, true)?;
        steps.finish();
        return Ok(());
    };
    let Some(build) = BUILDS.iter().find(|build| build.name == name) else {
        let names: Vec<&str> = BUILDS.iter().map(|build| build.name).collect();
        return Err(format!("there is no build `{name}`, but {}", names.join(", ")));
    };
    steps.announce(&build.machine.needs());
    check_builds(&mut steps, &[build], false)?;
    steps.finish();
    Ok(())
}

/// Advice if builds differ from each other.
const FIX: &str = "This build rounds or orders differently from the release build of this machine, which has the golden values:\n\
     renewing does not help. Look in the first stage that differs for what clippy.toml forbids, and for minima of zeros\n\
     of both signs, `usize` in arithmetic, or sorting with ties.";

/// Writes a new golden.txt.
pub fn renew() -> Result<()> {
    let golden = BASELINE.compile()?;
    let mut records = Vec::new();
    for case in SMALL.iter().chain([&LARGE]) {
        write_capture(case)?;
        records.push((case.name, BASELINE.measure(&golden, case, "sample")?));
    }
    let text = file::write(records.iter().map(|(name, record)| (*name, record)));
    fs::write(path(), text).map_err(|e| format!("{}: {e}", path().display()))
}

/// Folder for captures and records.
fn folder() -> PathBuf {
    target().join("golden/records")
}

fn capture(case: &Case) -> String {
    format!("{}.capture", case.name)
}

fn write_capture(case: &Case) -> Result<()> {
    let fail = |e| format!("{}: {e}", folder().display());
    fs::create_dir_all(folder()).map_err(fail)?;
    fs::write(folder().join(capture(case)), case.render().to_bytes()).map_err(fail)
}

fn path() -> PathBuf {
    root().join("tests/golden/golden.txt")
}

fn compare_with_file(case: &Case, got: &Record) -> Result<()> {
    let text = fs::read_to_string(path()).map_err(|e| format!("{}: {e}", path().display()))?;
    match difference(&file::find(&text, case.name)?, got) {
        None => Ok(()),
        Some(difference) => Err(format!("{}: {difference}{RENEW}", case.name)),
    }
}

/// How many numbers were compared.
fn counts(records: &[Record]) -> String {
    let arrays = records.iter().flat_map(|r| &r.stages).flat_map(|s| &s.arrays);
    format!("{} numbers", arrays.map(|a| a.length).sum::<usize>())
}

impl Build {
    /// Whether it is optimised and not emulated, so that the large capture takes seconds.
    fn is_quick(&self) -> bool {
        self.setting.is_none() && !matches!(self.machine, Machine::OldX86 | Machine::Aarch64)
    }

    /// Why this processor cannot run the build, if it cannot.
    fn impossible(&self) -> Option<String> {
        if (self.flags == AVX2.flags || self.machine == Machine::OldX86) && !has_avx2() {
            return Some("this processor has no AVX2".to_owned());
        }
        if self.flags == AVX512.flags && !has_avx512() {
            return Some("this processor has no AVX-512".to_owned());
        }
        if self.machine == Machine::Aarch64 && cfg!(target_arch = "aarch64") {
            return Some("this machine is AArch64".to_owned());
        }
        None
    }

    /// Compiles the program and returns its path. The next build for the same machine overwrites it.
    fn compile(&self) -> Result<PathBuf> {
        let triple = self.machine.triple()?;
        let folder = target().join("golden");
        let mut build = cargo("build --quiet --release --package golden --bin golden");
        // The target is named even for this machine, so that the flags do not apply to build scripts.
        build.args(["--target", &triple, "--target-dir"]).arg(&folder).env("CARGO_ENCODED_RUSTFLAGS", self.flags);
        build.env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", "aarch64-linux-gnu-gcc");
        self.setting.iter().for_each(|setting| _ = build.args(["--config", setting]));
        run(&mut build)?;
        let name = match self.machine {
            Machine::Wasi | Machine::Chromium => "golden.wasm",
            Machine::Windows => "golden.exe",
            Machine::This | Machine::OldX86 | Machine::Aarch64 => "golden",
        };
        Ok(folder.join(triple).join("release").join(name))
    }

    /// Runs the program on a capture file.
    fn measure(&self, golden: &Path, case: &Case, detail: &str) -> Result<Record> {
        let record = format!("{}.record", case.name);
        let mut command = self.machine.runner(golden)?;
        run(command.current_dir(folder()).args([case.preset, detail, &capture(case), &record]))?;
        fs::read_to_string(folder().join(record)).map_err(|e| format!("{}: {e}", folder().display()))?.parse()
    }
}

fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

/// Whether the processor has the instructions of x86-64-v4.
fn has_avx512() -> bool {
    #[cfg(target_arch = "x86_64")]
    return std::is_x86_feature_detected!("avx512f")
        && std::is_x86_feature_detected!("avx512bw")
        && std::is_x86_feature_detected!("avx512cd")
        && std::is_x86_feature_detected!("avx512dq")
        && std::is_x86_feature_detected!("avx512vl");
    #[cfg(not(target_arch = "x86_64"))]
    return false;
}

impl Machine {
    /// The target triple.
    fn triple(self) -> Result<String> {
        Ok(match self {
            Self::This | Self::OldX86 => run(&mut program("rustc", "--print host-tuple"))?.trim().to_owned(),
            Self::Wasi | Self::Chromium => WASI.to_owned(),
            Self::Aarch64 => AARCH64.to_owned(),
            Self::Windows => windows::TRIPLE.to_owned(),
        })
    }

    /// The standard library for it, a linker and an emulator.
    fn needs(self) -> Vec<Need> {
        match self {
            Self::This => vec![],
            Self::OldX86 => vec![EMULATOR],
            Self::Aarch64 => vec![LINKER[0], LINKER[1], EMULATOR, Need::Target(AARCH64)],
            Self::Windows => windows::NEEDS.to_vec(),
            Self::Wasi => vec![SCRIPTS[0], SCRIPTS[1], Need::Target(WASI)],
            Self::Chromium => vec![SCRIPTS[0], SCRIPTS[1], Need::Debian(CHROMIUM), Need::Target(WASI)],
        }
    }

    /// The command that runs a program for it. The program has access to the current folder.
    fn runner(self, built: &Path) -> Result<Command> {
        let through = |name: &str, arguments: &str| {
            let mut command = program(name, arguments);
            command.arg(built);
            command
        };
        Ok(match self {
            Self::Windows => windows::wine(built)?,
            Self::This => program(built, ""),
            Self::OldX86 => through("qemu-x86_64", "-cpu Nehalem"),
            Self::Aarch64 => through("qemu-aarch64", "-L /usr/aarch64-linux-gnu"),
            Self::Wasi | Self::Chromium => {
                let script = if self == Self::Wasi { "wasi.mjs" } else { "chromium.mjs" };
                let mut node = program("node", "");
                node.arg(root().join("tests/golden").join(script)).arg(built);
                node
            }
        })
    }
}
