//! Windows: the command line, the library, its CMake package and programs in C and C++, built by MinGW-w64 and run by Wine.
//! Their files are those of this machine, byte for byte. The golden values under Wine are a build of `cargo xtask golden`.

mod command;
mod package;
mod programs;

use crate::{
    Result,
    abi::problem,
    process::{cargo, program, root, run, target},
    setup::Need,
    steps::{Outcome, Steps, passed},
};
use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

pub const TRIPLE: &str = "x86_64-pc-windows-gnu";
const CC: &str = "x86_64-w64-mingw32-gcc";
/// The compiler whose library has threads.
const CXX: &str = "x86_64-w64-mingw32-g++-posix";

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
    [&NEEDS[..], &TOOLS, &CHECKED_NEEDS].concat()
}

/// Runs all checks.
pub fn check(steps: &mut Steps) -> Result<()> {
    let needs = [&NEEDS[..], &TOOLS].concat();
    let checks: [(&str, fn() -> Result<String>); 3] = [
        ("Windows: command line", command::check),
        ("Windows: C and C++ programs", programs::check),
        ("Windows: CMake package", package::check),
    ];
    for (name, check) in checks {
        steps.step_with(&needs, name, || match needs.iter().try_for_each(|need| need.install()) {
            Ok(()) => build().and_then(|()| check()).map(Outcome::Passed),
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

/// Folder of what is built and written.
fn work() -> PathBuf {
    target().join("windows")
}

/// Folder of Wine's drive C: and of its settings.
fn prefix() -> PathBuf {
    work().join("wine")
}

/// Folder of what Cargo has built for Windows.
fn built() -> PathBuf {
    target().join(TRIPLE).join("release")
}

/// An empty folder for the files of a check. Its path has spaces and letters that are not ASCII.
fn empty(name: &str) -> Result<PathBuf> {
    let folder = work().join("Aufnahme für Test").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(problem(&folder))?;
    }
    fs::create_dir_all(&folder).map_err(problem(&folder))?;
    Ok(folder)
}

/// Builds the command line and the library for this machine and for Windows.
fn build() -> Result<()> {
    run(&mut cargo("build --quiet --release -p pcmvs-cli -p pcmvs-ffi"))?;
    run(&mut cargo(&format!("build --quiet --release -p pcmvs-cli -p pcmvs-ffi --target {TRIPLE}"))).map(drop)
}

/// The command that runs a program by Wine. What Wine 8 lacks is built beside the program.
pub fn wine(exe: &Path) -> Result<Command> {
    let missing = exe.with_file_name("bcryptprimitives.dll");
    let mut cc = program(CC, "-shared -o");
    run(cc.arg(missing).arg(root().join("tests/windows/bcryptprimitives.c")).arg("-ladvapi32"))?;
    // The command line's meshoptimizer is in C++, whose libraries come with the compiler.
    let mut folders = vec![windows_path(&built())];
    for library in ["libstdc++-6.dll", "libgcc_s_seh-1.dll", "libwinpthread-1.dll"] {
        let path = run(program(CXX, "").arg(format!("-print-file-name={library}")))?;
        folders.extend(Path::new(path.trim()).parent().map(windows_path));
    }
    let mut wine = program("wine", "");
    wine.arg(exe).env("WINEPATH", folders.join(";")).env("WINEDEBUG", "-all").env("WINEPREFIX", prefix());
    // Without it names that are not ASCII get lost.
    wine.env("LC_ALL", "C.UTF-8");
    Ok(wine)
}

/// A path of this machine as Windows programs see it.
fn windows_path(path: &Path) -> String {
    format!("Z:{}", path.display()).replace('/', "\\")
}

/// Fails unless two files have the same bytes.
fn compare(here: &Path, there: &Path) -> Result<()> {
    let read = |path: &Path| fs::read(path).map_err(problem(path));
    if read(here)? == read(there)? {
        return Ok(());
    }
    Err(format!("{} and {} differ", here.display(), there.display()))
}
