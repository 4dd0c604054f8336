//! The sample of the page: a clip of the studio's figure, small enough to ship.

use crate::{
    Result,
    process::{cargo, program, root, run, target},
};
use image::{ColorType, ExtendedColorType, ImageEncoder, ImageFormat, codecs::jpeg::JpegEncoder};
use std::{
    fs,
    path::{Path, PathBuf},
};
use studio::{Capture, Faults, Ring, Subject, capture::record};

const FRAMES: usize = 8;
/// Frames per second. The clip lasts as long as one wave of the figure's hand, so that it loops.
const FPS: f64 = 8.0;
const JPEG_QUALITY: u8 = 85;

/// Renders the sample into a scene folder, unless the folder exists.
pub fn make(folder: &Path) -> Result<()> {
    if folder.join("scene.json").exists() {
        return Ok(());
    }
    let fail = |e: &dyn std::fmt::Display| format!("{}: {e}", folder.display());
    for name in ["images", "masks"] {
        fs::create_dir_all(folder.join(name)).map_err(|e| fail(&e))?;
    }
    let faults = Faults { noise: 1.0, gain: 0.03, ..Faults::default() };
    let mut capture = Capture::empty(&Ring::sample().cameras(), &faults);
    for i in 0..FRAMES {
        let mut frame = record(Subject::Figure, &capture.true_cameras, i, i as f64 / FPS, &faults);
        for (camera, picture) in frame.images.iter_mut().enumerate() {
            let name = &capture.names[camera];
            let mut jpeg = Vec::new();
            JpegEncoder::new_with_quality(&mut jpeg, JPEG_QUALITY)
                .write_image(&picture.rgb, picture.width, picture.height, ExtendedColorType::Rgb8)
                .map_err(|e| fail(&e))?;
            fs::write(folder.join(format!("images/{name}_{i:04}.jpg")), jpeg).map_err(|e| fail(&e))?;
            picture.rgb.clear();
            if let Some(mask) = &frame.masks[camera] {
                let path = folder.join(format!("masks/{name}_{i:04}.png"));
                image::save_buffer_with_format(
                    path,
                    mask,
                    picture.width,
                    picture.height,
                    ColorType::L8,
                    ImageFormat::Png,
                )
                .map_err(|e| fail(&e))?;
            }
        }
        capture.frames.push(frame);
    }
    let mut scene = capture.scene();
    scene.fps = Some(FPS);
    for path in scene.frames.iter_mut().flat_map(|frame| &mut frame.images).flatten() {
        path.set_extension("jpg");
    }
    let scene = serde_json::to_value(&scene).map_err(|e| fail(&e))?;
    // Written last, so that a folder that contains it is complete.
    fs::write(folder.join("scene.json"), format!("{scene:#}\n")).map_err(|e| fail(&e))
}

/// Reconstructs the sample with options of the command line.
pub fn reconstruct(options: &str, folder: &Path) -> Result<()> {
    let scene = root().join("web/public/sample");
    make(&scene)?;
    run(&mut cargo("build --quiet --release --package pcmvs-cli"))?;
    run(program(command(), &format!("reconstruct {options} -o")).arg(folder).arg(scene)).map(drop)
}

/// Packs a clip that was reconstructed.
pub fn pack(options: &str, clip: &Path, file: &Path) -> Result<()> {
    run(program(command(), &format!("pack {options} -o")).arg(file).arg(clip)).map(drop)
}

fn command() -> PathBuf {
    target().join("release/pcmvs")
}
