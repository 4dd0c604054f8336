//! `cargo xtask blender`: imports clips into Blender (see tests/blender).

use crate::{
    Result,
    process::{program, run, target},
    sample,
    setup::{Environment, Need},
    steps::{Outcome, Steps},
};

/// Blender as a Python module. Its wheels are for one version of Python only.
const BLENDER: Environment = Environment { name: "blender", python: "python3.11", packages: "bpy==5.0.1" };
pub const NEEDS: [Need; 1] = [Need::Pip(BLENDER)];

/// Clips that are imported, and the options with which they are made.
const CLIPS: [(&str, &str); 3] = [
    ("plain", "--preset hull"),
    ("textured", "--preset hull --texture=256 --faces 2000 --upright"),
    ("compressed", "--preset hull --compress --frames 0,1"),
];

/// Frames per second of the packed clip. Blender's frame rate is a fraction.
const PACKED_FPS: &str = "12.5";

/// The check alone.
pub fn run_alone() -> Result<()> {
    Steps::alone(&NEEDS, check)
}

/// Imports clips of the page's sample and checks what Blender has.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step_with(&NEEDS, "Blender", || {
        if run(&mut program(BLENDER.python, "--version")).is_err() {
            return Ok(Outcome::Skipped(format!("{} is missing, which Blender's package needs", BLENDER.python)));
        }
        NEEDS.iter().try_for_each(|need| need.install())?;
        let folder = target().join("blender-clips");
        for (name, options) in CLIPS {
            sample::reconstruct(options, &folder.join(name))?;
        }
        sample::pack(&format!("--fps {PACKED_FPS}"), &folder.join("plain"), &folder.join("packed.glb"))?;
        let printed = run(program(BLENDER.tool("python"), "tests/blender/check.py").arg(&folder).arg(PACKED_FPS))?;
        Ok(Outcome::Passed(printed.lines().last().unwrap_or_default().to_owned()))
    })
}
