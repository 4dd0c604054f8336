//! Windows: the command line, the library, its CMake package and programs in C and C++, built by MinGW-w64 and run by Wine.
//! Their files are those of this machine, byte for byte. The golden values under Wine are a build of `cargo xtask golden`.

mod command;
mod machine;
mod opencv;
mod package;
mod programs;

pub use machine::{TRIPLE, wine};

use crate::{
    Result,
    process::{cargo, run},
    setup::Need,
    steps::{Outcome, Steps, passed},
};

/// Compilers and an emulator.
pub const NEEDS: [Need; 4] = [
    Need::Debian(("gcc-mingw-w64-x86-64", "/usr/bin/x86_64-w64-mingw32-gcc")),
    Need::Debian(("g++-mingw-w64-x86-64", "/usr/bin/x86_64-w64-mingw32-g++-posix")),
    Need::Debian(("wine wine64", "/usr/lib/wine/wine64")),
    Need::Target(TRIPLE),
];

/// The tool that finds the CMake package, and the one that gives Wine a terminal.
const TOOLS: [Need; 2] = [Need::Debian(("cmake", "/usr/bin/cmake")), Need::Debian(("bsdutils", "/usr/bin/script"))];

/// Targets that are only checked, since nothing here can link or run their programs: MSVC's, and macOS.
const CHECKED: [&str; 2] = ["x86_64-pc-windows-msvc", "aarch64-apple-darwin"];
const CHECKED_NEEDS: [Need; 2] = [Need::Target(CHECKED[0]), Need::Target(CHECKED[1])];

/// What the checks need.
pub fn needs() -> Vec<Need> {
    [&NEEDS[..], &TOOLS, &[opencv::ZLIB], &CHECKED_NEEDS].concat()
}

/// Makes a check.
type Check = fn() -> Result<Outcome>;

/// Runs all checks.
pub fn check(steps: &mut Steps) -> Result<()> {
    let needs = [&NEEDS[..], &TOOLS].concat();
    let checks: [(&str, Check); 4] = [
        ("Windows: command line", || command::check().map(Outcome::Passed)),
        ("Windows: C and C++ programs", || programs::check().map(Outcome::Passed)),
        ("Windows: CMake package", || package::check().map(Outcome::Passed)),
        ("Windows: OpenCV", opencv::check),
    ];
    for (name, check) in checks {
        steps.step_with(&needs, name, || match needs.iter().try_for_each(|need| need.install()) {
            Ok(()) => build().and_then(|()| check()),
            Err(why) => Ok(Outcome::Skipped(why)),
        })?;
    }
    steps.step_with(&CHECKED_NEEDS, "MSVC and macOS: compiles", || {
        if let Err(why) = CHECKED_NEEDS.iter().try_for_each(|need| need.install()) {
            return Ok(Outcome::Skipped(why));
        }
        // The scene reader and the command line compile C and C++, for which the compilers of these targets are missing here.
        let check = "check --quiet -p pcmvs-core -p pcmvs-ffi --target";
        CHECKED.iter().try_for_each(|triple| run(cargo(check).arg(triple)).map(drop)).map(passed)
    })
}

/// Makes the checks alone.
pub fn test() -> Result<()> {
    Steps::alone(&needs(), check)
}

/// Builds the command line and the library for this machine and for Windows.
fn build() -> Result<()> {
    run(&mut cargo("build --quiet --release -p pcmvs-cli -p pcmvs-ffi"))?;
    run(&mut cargo(&format!("build --quiet --release -p pcmvs-cli -p pcmvs-ffi --target {TRIPLE}"))).map(drop)
}
