//! The command `studio`: renders a synthetic capture into a scene folder.

use clap::Parser;
use glam::DVec3;
use pcmvs_core::export::ply;
use rayon::prelude::*;
use std::{fs, io, path::PathBuf, process::ExitCode};
use studio::{Capture, Faults, Ring, Spots, Subject, capture::record, polygonise::polygonise};

/// Renders a synthetic capture: scene.json, images, masks and, with --truth, ground-truth meshes
#[derive(Debug, Parser)]
#[command(name = "studio", version)]
struct Arguments {
    /// Folder for the capture
    #[arg(short, long)]
    output: PathBuf,
    /// Render the sample: the figure, 20 views of 512x384, 12 frames, with some noise and gain
    #[arg(long, conflicts_with_all = ["scene", "views", "size", "frames", "noise", "gain"])]
    sample: bool,
    /// Subject in the dome
    #[arg(long, value_enum, default_value = "figure")]
    scene: Subject,
    /// Cameras on the ring
    #[arg(long, default_value_t = 20)]
    views: u32,
    /// Size of the pictures
    #[arg(long, default_value = "1024x768", value_parser = size)]
    size: (u32, u32),
    /// Number of frames
    #[arg(long, default_value_t = 1)]
    frames: u32,
    /// Frames per second
    #[arg(long, default_value_t = 25.0)]
    fps: f64,
    /// Lens distortion k1,k2,p1,p2,k3
    #[arg(long, value_parser = lens, allow_hyphen_values = true, default_value = "0,0,0,0,0")]
    distortion: [f64; 5],
    /// Standard deviation of the sensor noise in 8-bit levels
    #[arg(long, default_value_t = 0.0)]
    noise: f64,
    /// Read pictures through a Bayer mosaic and interpolate them
    #[arg(long)]
    mosaic: bool,
    /// Largest difference of a camera's gain from 1
    #[arg(long, default_value_t = 0.0)]
    gain: f64,
    /// Standard deviation of the blur in pixels
    #[arg(long, default_value_t = 0.0)]
    blur: f64,
    /// Calibration error in pixels
    #[arg(long, default_value_t = 0.0)]
    calibration: f64,
    /// Largest difference of a camera's clock in seconds
    #[arg(long, default_value_t = 0.0)]
    clock: f64,
    /// Cameras without masks, by index
    #[arg(long, value_delimiter = ',')]
    unmasked: Vec<usize>,
    /// Cameras without pictures, by index
    #[arg(long, value_delimiter = ',')]
    missing: Vec<usize>,
    /// Jagged masks, up to this many pixels too wide
    #[arg(long, default_value_t = 0)]
    coarse_masks: u32,
    /// Black and white masks
    #[arg(long)]
    binary_masks: bool,
    /// Distance in pixels of the masks' contours outside the true ones
    #[arg(long, allow_hyphen_values = true, default_value_t = 0.0)]
    wider_masks: f64,
    /// Root mean square in pixels of smooth errors of the masks' contours
    #[arg(long, default_value_t = 0.0)]
    contour_error: f64,
    /// Holes in every mask: their number and their diameter in pixels
    #[arg(long, value_name = "COUNTxDIAMETER", value_parser = spots, default_value = "0x0")]
    holes: Spots,
    /// Specks in the background of every mask: their number and their diameter in pixels
    #[arg(long, value_name = "COUNTxDIAMETER", value_parser = spots, default_value = "0x0")]
    specks: Spots,
    /// Quality of the pictures' JPEG compression
    #[arg(long, value_parser = clap::value_parser!(u8).range(1..=100))]
    jpeg: Option<u8>,
    /// Seed of everything random
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Also write ground-truth meshes with triangles of this size in millimetres
    #[arg(long)]
    truth: Option<f64>,
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let parsed = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match parsed {
        Some((w, h)) if w > 0 && h > 0 => Ok((w, h)),
        _ => Err("write the size as 1024x768".to_owned()),
    }
}

fn spots(text: &str) -> Result<Spots, String> {
    let parsed = text.split_once('x').and_then(|(count, d)| Some((count.parse().ok()?, d.parse().ok()?)));
    match parsed {
        Some((count, diameter)) if diameter >= 0.0 => Ok(Spots { count, diameter }),
        _ => Err("write the number and the diameter as 10x15".to_owned()),
    }
}

fn lens(text: &str) -> Result<[f64; 5], String> {
    let numbers: Vec<f64> = text.split(',').map_while(|n| n.trim().parse().ok()).collect();
    numbers.try_into().map_err(|_| "write the lens as five numbers k1,k2,p1,p2,k3".to_owned())
}

fn main() -> ExitCode {
    let mut arguments = Arguments::parse();
    if arguments.sample {
        (arguments.size, arguments.frames) = ((512, 384), 12);
        (arguments.noise, arguments.gain) = (1.5, 0.04);
    }
    match run(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("studio: {}: {error}", arguments.output.display());
            ExitCode::FAILURE
        }
    }
}

fn run(a: &Arguments) -> io::Result<()> {
    if a.mosaic && (a.size.0 < 2 || a.size.1 < 2) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "--mosaic needs pictures of at least 2x2 pixels"));
    }
    let ring = Ring { count: a.views, distortion: a.distortion, ..Ring::default() }.sized(a.size.0, a.size.1);
    let faults = Faults {
        noise: a.noise,
        mosaic: a.mosaic,
        gain: a.gain,
        blur: a.blur,
        calibration: a.calibration,
        bumped: Vec::new(),
        clock: a.clock,
        unmasked: a.unmasked.clone(),
        missing: a.missing.clone(),
        coarse_masks: a.coarse_masks,
        binary_masks: a.binary_masks,
        wider_masks: a.wider_masks,
        contour_error: a.contour_error,
        holes: a.holes,
        specks: a.specks,
        jpeg: a.jpeg,
        seed: a.seed,
    };
    let capture = Capture::empty(&ring.cameras(), &faults);
    let one = |i: usize| {
        let frame = record(a.scene, &capture.true_cameras, i, i as f64 / a.fps, &faults);
        if let Some(millimetres) = a.truth {
            let folder = a.output.join("gt");
            fs::create_dir_all(&folder)?;
            let mesh = polygonise(&frame.truth, millimetres / 1000.0).to_core(&frame.truth);
            fs::write(folder.join(format!("frame_{i:04}.ply")), ply::write_mesh(&mesh, DVec3::ZERO))?;
        }
        let entry = capture.write_frame(&a.output, i, &frame)?;
        eprintln!("studio: frame {i} of {}", a.frames);
        Ok(entry)
    };
    let entries = (0..a.frames as usize).into_par_iter().map(one).collect::<io::Result<Vec<_>>>()?;
    capture.write_scene_file(&a.output, entries)
}
