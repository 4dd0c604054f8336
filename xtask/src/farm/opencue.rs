//! A clip made by the job that examples/farm/opencue sends to an OpenCue farm. There is no farm: its description is made by
//! OpenCue's own packages, and its tasks are run as OpenCue's hosts run them.

use super::clip::{FRAMES, FRAMES_PER_PART, built, compare, folder, scene, single};
use crate::{
    Result,
    process::{program, root, run},
    setup::{Environment, Need},
};
use std::fs;

/// OpenCue's packages. The newest of them does not name `packaging`, which it needs.
const ENVIRONMENT: Environment =
    Environment { name: "opencue", python: "python3", packages: "opencue-pyoutline==1.37.0 packaging" };
pub const PACKAGES: Need = Need::Pip(ENVIRONMENT);

/// Makes the clip and compares it with that of one machine.
pub fn check() -> Result<String> {
    // A space must reach the shell as the shell wants it.
    let clip = folder().join("a clip");
    let mut submit = program(ENVIRONMENT.tool("python"), "examples/farm/opencue/submit.py --print --cores 1 --pcmvs");
    submit.arg(built("pcmvs")).arg(scene()).arg(&clip);
    submit.args([String::from("0"), (FRAMES - 1).to_string(), FRAMES_PER_PART.to_string()]);
    let description = run(submit.current_dir(root()).env("HOME", folder()))?;
    let file = folder().join("opencue.xml");
    fs::write(&file, description).map_err(|e| format!("{}: {e}", file.display()))?;
    let done = run(program(ENVIRONMENT.tool("python"), "tests/farm/run_job.py").arg(&file).current_dir(root()))?;
    compare(&single(), &clip)?;
    Ok(format!("{}, one of them killed; bytes of a single machine", done.trim()))
}
