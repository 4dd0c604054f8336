//! The forms of a mesh and pictures of them, with which players and Blender are compared.

use crate::{Result, sample};
use image::{ColorType, ImageFormat};
use serde_json::json;
use std::{f64::consts::FRAC_PI_4, fs, path::Path};
use studio::{
    Ring,
    look::{ColouredMesh, Drawing, draw},
};

/// The camera on a ring of eight that looks: the second one, by an eighth of a turn from the scene's +x.
const CAMERA: usize = 1;

/// Pixels of a picture's side.
const SIZE: u32 = 512;

/// A form of a mesh, which players must show upright by themselves.
struct FormCase {
    name: &'static str,
    options: &'static str,
    /// Options of the form that our own picture shows: neither compressed nor upright.
    reference: &'static str,
    /// Least PSNR in decibels.
    required: u32,
}

const PLAIN_DECIBELS: u32 = 35;
const COMPACT_DECIBELS: u32 = 32;
const FORMS: [FormCase; 5] = [
    FormCase { name: "full", options: "--upright", reference: "", required: PLAIN_DECIBELS },
    FormCase { name: "texture", options: "--texture --upright", reference: "--texture", required: PLAIN_DECIBELS },
    FormCase { name: "compress", options: "--compress --upright", reference: "", required: COMPACT_DECIBELS },
    FormCase {
        name: "web",
        options: "--faces 20000 --texture=1024 --compress --upright",
        reference: "--faces 20000 --texture=1024",
        required: COMPACT_DECIBELS,
    },
    FormCase {
        name: "mobile",
        options: "--faces 5000 --texture=512 --compress --upright",
        reference: "--faces 5000 --texture=512",
        required: COMPACT_DECIBELS,
    },
];
/// One frame of the sample, by itself.
const ONE_FRAME: &str = "--frames 0 --alone";

/// Reconstructs every form of a frame of the sample into the folder `forms/NAME`, and draws it into `ours/forms/NAME.png`. What
/// must be reached is in `forms.json`, and the camera, as players take it, in `view.json`.
pub fn make(folder: &Path) -> Result<()> {
    let fail = |e: &dyn std::fmt::Display| format!("{}: {e}", folder.display());
    fs::create_dir_all(folder.join("ours/forms")).map_err(|e| fail(&e))?;
    for FormCase { name, options, reference, .. } in FORMS {
        sample::reconstruct(&format!("{ONE_FRAME} {options}"), &folder.join("forms").join(name))?;
        let plain = folder.join("references").join(name);
        sample::reconstruct(&format!("{ONE_FRAME} {reference}"), &plain)?;
        picture(&plain.join("frame_0000.glb"), &folder.join("ours/forms").join(name).with_extension("png"))?;
    }
    let forms: Vec<_> = FORMS.iter().map(|form| json!({ "name": form.name, "required": form.required })).collect();
    fs::write(folder.join("forms.json"), json!(forms).to_string()).map_err(|e| fail(&e))?;
    fs::write(folder.join("view.json"), view().to_string()).map_err(|e| fail(&e))
}

fn ring() -> Ring {
    Ring { count: 8, unevenness: 0.0, ..Ring::default() }.sized(SIZE, SIZE)
}

/// The camera, as tests/players/page/three.js explains it.
fn view() -> serde_json::Value {
    let ring = ring();
    // The angles are those of CAMERA. Players have up at +y, and the scene's -y at +z.
    let target = ring.look_at;
    let above = ring.height - target.z;
    json!({
        "size": SIZE,
        "target": [target.x, target.z, -target.y],
        "radius": libm::hypot(ring.radius, above),
        "theta": 3.0 * FRAC_PI_4,
        "phi": libm::atan2(ring.radius, above),
        "fov": ring.fov,
    })
}

/// Draws the mesh of a file, on a transparent background.
pub fn picture(file: &Path, output: &Path) -> Result<()> {
    let mesh = ColouredMesh::read(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let Drawing { colours, covered, .. } = draw(&mesh, &ring().cameras()[CAMERA]);
    let pixels = colours.rgb.chunks_exact(3).zip(&covered);
    let rgba: Vec<u8> = pixels.flat_map(|(c, &covered)| [c[0], c[1], c[2], u8::from(covered) * 255]).collect();
    image::save_buffer_with_format(output, &rgba, SIZE, SIZE, ColorType::Rgba8, ImageFormat::Png)
        .map_err(|e| format!("{}: {e}", output.display()))
}
