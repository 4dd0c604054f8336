//! `cargo xtask players`: plays a clip in common players and compares them with our own pictures of it (see
//! tests/players).

use crate::{
    Result,
    process::{program, root, run, target},
    sample,
    setup::{CHROMIUM, Need},
    steps::{Outcome, Steps},
};
use image::{ColorType, ImageFormat};
use serde_json::json;
use std::{f64::consts::FRAC_PI_4, fs, path::Path};
use studio::{
    Ring,
    look::{ColouredMesh, Drawing, draw},
};

/// Pixels of a picture's side.
const SIZE: u32 = 512;

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
        look(&folder)?;
        NEEDS.iter().try_for_each(|need| need.install())?;
        let measured = run(program("node", "players.mjs").arg(&folder).current_dir(&tests))?;
        Ok(Outcome::Passed(format!("\n{}", measured.trim_end())))
    })
}

/// Writes the camera, as players take it, and what it sees of every frame.
fn look(folder: &Path) -> Result<()> {
    let fail = |e: &dyn std::fmt::Display| format!("{}: {e}", folder.display());
    let ring = Ring { count: 8, unevenness: 0.0, ..Ring::default() }.sized(SIZE, SIZE);
    // The second camera, by an eighth of a turn from the scene's +x. Players have up at +y, and the scene's -y at +z.
    let camera = ring.cameras()[1];
    let target = ring.look_at;
    let above = ring.height - target.z;
    let view = json!({
        "size": SIZE,
        "target": [target.x, target.z, -target.y],
        "radius": libm::hypot(ring.radius, above),
        "theta": 3.0 * FRAC_PI_4,
        "phi": libm::atan2(ring.radius, above),
        "fov": ring.fov,
    });
    fs::create_dir_all(folder.join("ours")).map_err(|e| fail(&e))?;
    fs::write(folder.join("view.json"), view.to_string()).map_err(|e| fail(&e))?;
    let manifest = fs::read(folder.join("clip/sequence.json")).map_err(|e| fail(&e))?;
    let manifest: serde_json::Value = serde_json::from_slice(&manifest).map_err(|e| fail(&e))?;
    for frame in manifest["frames"].as_array().into_iter().flatten() {
        let name = frame["url"].as_str().ok_or_else(|| fail(&"a frame has no file"))?;
        let mesh = ColouredMesh::read(&folder.join("clip").join(name)).map_err(|e| fail(&e))?;
        let Drawing { colours, covered, .. } = draw(&mesh, &camera);
        let pixels = colours.rgb.chunks_exact(3).zip(&covered);
        let rgba: Vec<u8> = pixels.flat_map(|(c, &covered)| [c[0], c[1], c[2], u8::from(covered) * 255]).collect();
        let path = folder.join("ours").join(name).with_extension("png");
        image::save_buffer_with_format(path, &rgba, SIZE, SIZE, ColorType::Rgba8, ImageFormat::Png)
            .map_err(|e| fail(&e))?;
    }
    Ok(())
}
