//! `cargo xtask blender`: imports clips into Blender (see tests/blender).

use crate::{
    Result, forms,
    process::{program, run, target},
    sample,
    setup::{Environment, Need},
    steps::{Outcome, Steps},
};
use std::fs;

/// Blender as a Python module. Its wheels are for one version of Python only.
const BLENDER: Environment = Environment { name: "blender", python: "python3.11", packages: "bpy==5.0.1" };
pub const NEEDS: [Need; 1] = [Need::Pip(BLENDER)];

/// Clips that are imported, and the options with which they are made.
const CLIPS: [(&str, &str); 4] = [
    ("plain", "--preset hull"),
    ("textured", "--preset hull --texture=256 --faces 2000 --upright"),
    ("compressed", "--preset hull --compress"),
    ("upright", "--preset hull --upright --frames 0"),
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
        let sound = folder.join("sound.wav");
        fs::write(&sound, silence()).map_err(|e| format!("{}: {e}", sound.display()))?;
        let options = format!(
            "--manifest --segment 0.5 --quality compact={} --audio {}",
            folder.join("compressed").display(),
            sound.display()
        );
        sample::pack(&options, &folder.join("plain"), &folder.join("published"))?;
        let python = |script: &str| {
            let mut command = program(BLENDER.tool("python"), script);
            command.env("PYTHONDONTWRITEBYTECODE", "1").arg(&folder);
            command
        };
        let printed = run(python("tests/blender/check.py").arg(PACKED_FPS))?;
        run(python("tests/blender/install.py").env("BLENDER_USER_RESOURCES", folder.join("settings")))?;
        forms::make(&folder)?;
        let pictures = run(&mut python("tests/blender/pictures.py"))?;
        let measured = pictures.lines().filter(|line| line.contains(" dB"));
        let summary = printed.lines().last().unwrap_or_default().to_owned();
        Ok(Outcome::Passed(measured.fold(summary, |text, line| format!("{text}\n  {line}"))))
    })
}

/// A WAV file of one second without a sound: 8000 samples of 8 bits.
fn silence() -> Vec<u8> {
    const RATE: u32 = 8000;
    let mut wav = Vec::new();
    wav.extend_from_slice(b"RIFF");
    wav.extend_from_slice(&(36 + RATE).to_le_bytes());
    wav.extend_from_slice(b"WAVEfmt ");
    wav.extend_from_slice(&16_u32.to_le_bytes());
    // Numbers as they are, one channel.
    wav.extend_from_slice(&[1, 0, 1, 0]);
    // Samples and bytes per second, then bytes and bits per sample.
    wav.extend_from_slice(&[RATE.to_le_bytes(), RATE.to_le_bytes()].concat());
    wav.extend_from_slice(&[1, 0, 8, 0]);
    wav.extend_from_slice(b"data");
    wav.extend_from_slice(&RATE.to_le_bytes());
    wav.resize(wav.len() + RATE as usize, 128);
    wav
}
