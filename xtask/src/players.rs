//! `cargo xtask players`: plays a clip in common players and compares them with our own pictures of it (see
//! tests/players).

use crate::{
    Result, forms,
    process::{program, root, run, target},
    sample,
    setup::{CHROMIUM, Need},
    steps::{Outcome, Steps},
};
use std::{fs, path::Path};

/// Options of another clip, as viewers on the web want it.
const COMPRESSED: &str = "--preset hull --faces 20000 --texture=512 --compress --upright";
/// Clips in one file: folders, names, and options of `pcmvs pack`.
const PACKED: [(&str, &str, &str); 3] =
    [("clip", "packed.glb", ""), ("clip", "visibility.glb", "--visibility"), ("compressed", "packed.glb", "")];

pub const NEEDS: [Need; 3] = [Need::Debian(CHROMIUM), Need::Npm("tests/web"), Need::Npm("tests/players")];

/// The check alone.
pub fn run_alone() -> Result<()> {
    Steps::alone(&NEEDS, check)
}

/// Reconstructs the page's sample with the command line and plays it in a browser.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step_with(&NEEDS, "players", || {
        let (folder, tests) = (target().join("players"), root().join("tests/players"));
        sample::reconstruct("", &folder.join("clip"))?;
        sample::reconstruct(COMPRESSED, &folder.join("compressed"))?;
        for (clip, name, options) in PACKED {
            let clip = folder.join(clip);
            sample::pack(options, &clip, &clip.join(name))?;
        }
        forms::make(&folder)?;
        look(&folder)?;
        NEEDS.iter().try_for_each(|need| need.install())?;
        let measured = run(program("node", "players.mjs").arg(&folder).current_dir(&tests))?;
        Ok(Outcome::Passed(format!("\n{}", measured.trim_end())))
    })
}

/// Draws every frame of the clip into `ours`.
fn look(folder: &Path) -> Result<()> {
    let fail = |e: &dyn std::fmt::Display| format!("{}: {e}", folder.display());
    let manifest = fs::read(folder.join("clip/sequence.json")).map_err(|e| fail(&e))?;
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).map_err(|e| fail(&e))?;
    for frame in manifest["frames"].as_array().into_iter().flatten() {
        let name = frame["url"].as_str().ok_or_else(|| fail(&"a frame has no file"))?;
        forms::picture(&folder.join("clip").join(name), &folder.join("ours").join(name).with_extension("png"))?;
    }
    Ok(())
}
