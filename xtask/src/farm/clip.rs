//! The take of which clips are made, and the clip of one machine that all others are compared with.

use crate::{
    Result,
    process::{program, run, target},
};
use std::{
    fs,
    path::{Path, PathBuf},
    time::Duration,
};

pub const FRAMES: u32 = 24;
pub const FRAMES_PER_PART: u32 = 4;
/// Longest time for anything that is waited for: Slurm gives up on a node after some ten seconds.
pub const PATIENCE: Duration = Duration::from_secs(300);

pub fn is_root() -> Result<bool> {
    Ok(run(&mut program("id", "-u"))?.trim() == "0")
}

pub fn folder() -> PathBuf {
    target().join("farm")
}

/// The capture of the take.
pub fn scene() -> PathBuf {
    folder().join("scene")
}

/// The clip that all others are compared with.
pub fn single() -> PathBuf {
    folder().join("single")
}

pub fn built(name: &str) -> PathBuf {
    target().join("debug").join(name)
}

/// Makes the capture, and its clip in one run.
pub fn make() -> Result<String> {
    if folder().exists() {
        fs::remove_dir_all(folder()).map_err(|e| format!("{}: {e}", folder().display()))?;
    }
    let studio = format!("--size 240x180 --views 12 --frames {FRAMES} --output");
    run(program(built("studio"), &studio).arg(scene()))?;
    run(program(built("pcmvs"), "reconstruct --threads 1").arg(scene()).arg("-o").arg(single()))?;
    Ok(format!("{FRAMES} frames"))
}

/// Compares two clips, except for their reports, which have times.
pub fn compare(single: &Path, clip: &Path) -> Result<()> {
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
