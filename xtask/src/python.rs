//! The Python package: its wheel is built, installed in a virtual environment and tested there.

use crate::{
    Result,
    process::{cargo_environment, program, run, target},
    setup::{Environment, Need},
    steps::{Outcome, Steps},
};
use std::{fs, path::PathBuf, process::Command};

/// The builder of wheels, and what tests and type stubs need.
const ENVIRONMENT: Environment =
    Environment { name: "python-package", python: "python3", packages: "maturin>=1.9,<2 mypy>=1.18 numpy pytest>=8" };
pub const NEEDS: [Need; 1] = [Need::Pip(ENVIRONMENT)];

/// Makes the checks alone.
pub fn test() -> Result<()> {
    Steps::alone(&NEEDS, |steps| {
        steps.build_commands()?;
        check(steps)
    })
}

/// Builds the wheel and tests it, with the command line and the studio that have been built before.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step_with(&NEEDS, "Python package", || match NEEDS[0].install() {
        Ok(()) => tests().map(Outcome::Passed),
        Err(why) => Ok(Outcome::Skipped(why)),
    })
}

/// A program of the virtual environment.
fn tool(name: &str, arguments: &str) -> Command {
    let mut command = program(ENVIRONMENT.tool(name), arguments);
    command.env("PYTHONDONTWRITEBYTECODE", "1");
    command
}

fn work() -> PathBuf {
    target().join("python-package")
}

fn tests() -> Result<String> {
    let wheel = wheel()?;
    run(tool("pip", "install --quiet --no-deps --force-reinstall").arg(&wheel))?;
    // The stubs say what the module has, and the example is right by them.
    fs::create_dir_all(work()).map_err(|e| format!("{}: {e}", work().display()))?;
    run(tool("python", "-m mypy.stubtest pcmvs").current_dir(work()))?;
    let cache = work().join("mypy");
    run(tool("mypy", "--strict --cache-dir").arg(cache).arg("examples/python/reconstruct.py"))?;
    // The decoder of the Blender extension needs NumPy only.
    let printed = run(tool("pytest", "-q -p no:cacheprovider tests/python tests/blender/test_decoder.py")
        .env("PCMVS_CAPTURE", capture()?)
        .env("PCMVS_COMMAND", built("pcmvs")))?;
    let size = fs::metadata(&wheel).map_err(|e| format!("{}: {e}", wheel.display()))?.len();
    let summary = printed.lines().last().unwrap_or_default();
    Ok(format!("{summary}; wheel of {} KiB without optimisation across crates", size >> 10))
}

/// Builds the wheel, optimised as all tests are: a release build would take longer than it saves.
fn wheel() -> Result<PathBuf> {
    let folder = work().join("wheels");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let mut build = tool("maturin", "build --quiet --profile dev --manifest-path python/Cargo.toml --out");
    run(cargo_environment(build.arg(&folder)))?;
    let files = fs::read_dir(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let found = files.flatten().map(|file| file.path()).find(|path| path.extension().is_some_and(|e| e == "whl"));
    found.ok_or_else(|| format!("{}: maturin wrote no wheel", folder.display()))
}

/// A program that has been built with the tests.
fn built(name: &str) -> PathBuf {
    target().join("debug").join(name)
}

/// A small capture.
fn capture() -> Result<PathBuf> {
    let folder = work().join("capture");
    if !folder.join("scene.json").exists() {
        run(program(built("studio"), "--size 160x120 --views 12 --frames 2 --fps 4 --output").arg(&folder))?;
    }
    Ok(folder)
}
