//! `cargo xtask farm`: clips made by the scripts of examples/farm have the bytes of one that a single machine has made.

mod opencue;
mod slurm;

mod trouble;

use crate::{
    Result,
    process::{program, run, target},
    setup::Need,
    steps::{Outcome, Steps},
};
use std::{
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

pub const NEEDS: [Need; 2] = [slurm::SLURM, opencue::PACKAGES];

const FRAMES: u32 = 24;
const FRAMES_PER_PART: u32 = 4;
/// Longest time for anything that is waited for: Slurm gives up on a node after some ten seconds.
const PATIENCE: Duration = Duration::from_secs(300);

/// Makes the checks alone.
pub fn test() -> Result<()> {
    Steps::alone(&NEEDS, |steps| {
        steps.build_commands()?;
        check(steps)
    })
}

/// Makes a clip on farms and on one machine, with the command line and the studio that have been built before.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step("take on one machine", || on_one_machine().map(Outcome::Passed))?;
    steps.step("take: killed, disk full, no input", || trouble::check().map(Outcome::Passed))?;
    steps.step_with(&[slurm::SLURM], "farm: Slurm, a node is killed", || {
        if !is_root()? {
            return Ok(Outcome::Skipped(String::from("Slurm's node daemons need the rights of root")));
        }
        match slurm::SLURM.install() {
            Ok(()) => slurm::check().map(Outcome::Passed),
            Err(why) => Ok(Outcome::Skipped(why)),
        }
    })?;
    steps.step_with(&[opencue::PACKAGES], "farm: OpenCue, a task is killed", || match opencue::PACKAGES.install() {
        Ok(()) => opencue::check().map(Outcome::Passed),
        Err(why) => Ok(Outcome::Skipped(why)),
    })
}

fn is_root() -> Result<bool> {
    Ok(run(&mut program("id", "-u"))?.trim() == "0")
}

fn folder() -> PathBuf {
    target().join("farm")
}

/// The capture of the take.
fn scene() -> PathBuf {
    folder().join("scene")
}

/// The clip that all others are compared with.
fn single() -> PathBuf {
    folder().join("single")
}

fn built(name: &str) -> PathBuf {
    target().join("debug").join(name)
}

/// Makes the capture, and its clip in one run.
fn on_one_machine() -> Result<String> {
    if folder().exists() {
        fs::remove_dir_all(folder()).map_err(|e| format!("{}: {e}", folder().display()))?;
    }
    let studio = format!("--size 240x180 --views 12 --frames {FRAMES} --output");
    run(program(built("studio"), &studio).arg(scene()))?;
    run(program(built("pcmvs"), "reconstruct --threads 1").arg(scene()).arg("-o").arg(single()))?;
    Ok(format!("{FRAMES} frames"))
}

/// Compares two clips, except for their reports, which have times.
fn compare(single: &Path, clip: &Path) -> Result<()> {
    let names = |folder: &Path| -> Result<Vec<_>> {
        let entries = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut names: Vec<_> = entries.flatten().map(|entry| entry.file_name()).collect();
        names.sort();
        Ok(names)
    };
    let (expected, found) = (names(single)?, names(clip)?);
    if expected != found {
        return Err(format!("the clips have different files: {expected:?} and {found:?}"));
    }
    let read = |path: PathBuf| fs::read(&path).map_err(|e| format!("{}: {e}", path.display()));
    for name in expected.iter().filter(|name| *name != "report.json") {
        if read(single.join(name))? != read(clip.join(name))? {
            return Err(format!("{} differs from that of a single machine", clip.join(name).display()));
        }
    }
    Ok(())
}
