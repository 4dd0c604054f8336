//! `cargo xtask farm`: clips made by the scripts of examples/farm have the bytes of one that a single machine has made.

mod clip;
mod opencue;
mod slurm;
mod trouble;

use crate::{
    Result,
    setup::Need,
    steps::{Outcome, Steps},
};

pub const NEEDS: [Need; 2] = [slurm::SLURM, opencue::PACKAGES];

/// Makes the checks alone.
pub fn test() -> Result<()> {
    Steps::alone(&NEEDS, |steps| {
        steps.build_commands()?;
        check(steps)
    })
}

/// Makes a clip on farms and on one machine, with the command line and the studio that have been built before.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step("take on one machine", || clip::make().map(Outcome::Passed))?;
    steps.step("take: killed, disk full, no input", || trouble::check().map(Outcome::Passed))?;
    steps.step_with(&[slurm::SLURM], "farm: Slurm, a node is killed", || {
        if !clip::is_root()? {
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
