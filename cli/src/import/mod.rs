//! `pcmvs import`: other programs' calibrations as scenes.

use crate::{arguments::Import, failure::Failure};

/// Runs the command.
pub fn run(options: &Import) -> Result<(), Failure> {
    Err(Failure::Input(format!("{:?}", options)))
}
