//! Windows: the command line, the library and programs in C, built by MinGW-w64 and run by Wine. Their files are those of
//! this machine, byte for byte.

use crate::{
    Result,
    abi::problem,
    process::{cargo, program, root, run, target},
    sample,
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
const CXX: &str = "x86_64-w64-mingw32-g++";

/// Compilers and an emulator.
pub const NEEDS: [Need; 4] = [
    Need::Debian(("gcc-mingw-w64-x86-64", "/usr/bin/x86_64-w64-mingw32-gcc")),
    Need::Debian(("g++-mingw-w64-x86-64", "/usr/bin/x86_64-w64-mingw32-g++")),
    Need::Debian(("wine wine64", "/usr/lib/wine/wine64")),
    Need::Target(TRIPLE),
];

/// Targets that are only checked, since nothing here can link or run their programs: MSVC's, and macOS.
const CHECKED: [&str; 2] = ["x86_64-pc-windows-msvc", "aarch64-apple-darwin"];
const CHECKED_NEEDS: [Need; 2] = [Need::Target(CHECKED[0]), Need::Target(CHECKED[1])];

/// Options of the command line for the compared files, besides the default.
const WEB: &str = "--faces 5000 --texture=256 --compress --upright";

/// What the checks need.
pub fn needs() -> Vec<Need> {
    [&NEEDS[..], &CHECKED_NEEDS].concat()
}

/// Runs all checks.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step_with(&NEEDS, "Windows: command line and C programs", || {
        match NEEDS.iter().try_for_each(|need| need.install()) {
            Ok(()) => same_files().map(Outcome::Passed),
            Err(why) => Ok(Outcome::Skipped(why)),
        }
    })?;
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

/// The command that runs a program by Wine. What Wine 8 lacks is built beside the program.
pub fn wine(exe: &Path) -> Result<Command> {
    let missing = exe.with_file_name("bcryptprimitives.dll");
    let mut cc = program(CC, "-shared -o");
    run(cc.arg(missing).arg(root().join("tests/windows/bcryptprimitives.c")).arg("-ladvapi32"))?;
    // The command line's meshoptimizer is in C++, whose library comes with the compiler.
    let library = run(&mut program(CXX, "-print-file-name=libstdc++-6.dll"))?;
    let folder = Path::new(library.trim()).parent().map(windows_path).unwrap_or_default();
    let mut wine = program("wine", "");
    wine.arg(exe).env("WINEPATH", folder).env("WINEDEBUG", "-all").env("WINEPREFIX", work().join("wine"));
    // Without it names that are not ASCII get lost.
    wine.env("LC_ALL", "C.UTF-8");
    Ok(wine)
}

/// A path of this machine as Windows programs see it.
fn windows_path(path: &Path) -> String {
    format!("Z:{}", path.display()).replace('/', "\\")
}

fn same_files() -> Result<String> {
    run(&mut cargo("build --quiet --release -p pcmvs-cli -p pcmvs-ffi"))?;
    run(&mut cargo(&format!("build --quiet --release -p pcmvs-cli -p pcmvs-ffi --target {TRIPLE}")))?;
    let built = target().join(TRIPLE).join("release");
    if work().join("files").exists() {
        fs::remove_dir_all(work().join("files")).map_err(problem(&work()))?;
    }
    // Spaces and letters that are not ASCII.
    let files = work().join("files/Aufnahme für Test");
    fs::create_dir_all(&files).map_err(problem(&files))?;
    let scene = root().join("web/public/sample");
    sample::make(&scene)?;
    // With the average over its neighbours in the take.
    for options in ["", WEB] {
        let options = format!("reconstruct --frames 0 {options}");
        let (here, there) = (files.join("here"), files.join("there"));
        run(program(target().join("release/pcmvs"), &options).arg(&scene).arg("-o").arg(&here))?;
        let mut command = wine(&built.join("pcmvs.exe"))?;
        command.args(options.split_whitespace()).arg(windows_path(&scene)).arg("-o").arg(windows_path(&there));
        run(&mut command)?;
        for name in ["frame_0000.glb", "sequence.json"] {
            compare(&here.join(name), &there.join(name))?;
        }
        for folder in [here, there] {
            fs::remove_dir_all(&folder).map_err(problem(&folder))?;
        }
    }
    let programs = ["examples/c/reconstruct.c", "tests/c/forms.c"];
    let plain = files.join("plain");
    run(cargo("run --quiet --release -p pcmvs-ffi --example plain_capture").arg(&plain))?;
    for source in programs {
        let name = Path::new(source).file_stem().unwrap_or_default().to_string_lossy();
        let (here, there) = (files.join(format!("{name}.glb")), files.join(format!("{name} of Windows.glb")));
        let (native, exe) = (files.join(&*name), built.join(format!("{name}.exe")));
        compile("cc", source, &native, &target().join("release"))?;
        run(program(native, "").arg(&plain).arg(&here))?;
        compile(CC, source, &exe, &built)?;
        run(wine(&exe)?.arg(windows_path(&plain)).arg(windows_path(&there)))?;
        compare(&here, &there)?;
    }
    Ok(format!("2 forms by the command line, {} programs in C", programs.len()))
}

/// Compiles a program in C with the library of a folder: on Windows the shared one.
fn compile(compiler: &str, source: &str, to: &Path, library: &Path) -> Result<()> {
    let mut command = program(compiler, "-std=c99 -O1 -Wall -Wextra -Werror -o");
    command.arg(to).arg(root().join(source)).arg("-I").arg(root().join("include"));
    command.arg("-I").arg(root().join("examples/c"));
    if compiler == CC {
        command.arg(library.join("libpcmvs.dll.a"));
    } else {
        command.arg(library.join("libpcmvs.a")).args(["-lm", "-lpthread", "-ldl"]);
    }
    run(&mut command).map(drop)
}

fn compare(here: &Path, there: &Path) -> Result<()> {
    let read = |path: &Path| fs::read(path).map_err(problem(path));
    if read(here)? == read(there)? {
        return Ok(());
    }
    Err(format!("{} and {} differ", here.display(), there.display()))
}
