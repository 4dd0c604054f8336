//! The command `look`: a contact sheet of a reconstruction with photographs, shape and colours.

use clap::Parser;
use image::{
    ExtendedColorType, ImageEncoder,
    codecs::png::{CompressionType, FilterType, PngEncoder},
};
use std::{error::Error, fs::File, io::BufWriter, path::PathBuf, process::ExitCode};
use studio::look::{ColouredMesh, sheet};

/// Draws a mesh as cameras of its scene see it, next to the photographs
#[derive(Debug, Parser)]
#[command(name = "look", version)]
struct Arguments {
    /// Folder with scene.json
    scene: PathBuf,
    /// GLB file of the frame
    mesh: PathBuf,
    /// PNG file to write
    #[arg(short, long)]
    output: PathBuf,
    /// Index of the frame
    #[arg(long, default_value_t = 0)]
    frame: u32,
    /// Cameras, by their position in scene.json
    #[arg(long, value_delimiter = ',', default_values_t = [0, 7, 14])]
    cameras: Vec<usize>,
}

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("look: {}, {}: {error}", arguments.scene.display(), arguments.mesh.display());
            ExitCode::FAILURE
        }
    }
}

fn run(a: &Arguments) -> Result<(), Box<dyn Error>> {
    let sheet = sheet(&a.scene, a.frame, &ColouredMesh::read(&a.mesh)?, &a.cameras)?;
    let file = BufWriter::new(File::create(&a.output)?);
    let encoder = PngEncoder::new_with_quality(file, CompressionType::Best, FilterType::Adaptive);
    encoder.write_image(&sheet.rgb, sheet.width, sheet.height, ExtendedColorType::Rgb8)?;
    Ok(())
}
