//! Reconstructs a small synthetic capture and writes the mesh as GLB: `cargo run --release --example reconstruct [out.glb]`.
//!
//! The test studio renders a person in 12 views. A real program would load photographs, masks and a calibration instead.

use pcmvs_core::{
    Frame, Mask, Memory, Params, Preset, Progress, Rig, Serial, Stage, ViewInput, export::glb, frame::ORDER,
};
use std::{error::Error, fs, time::Instant};
use studio::{Capture, Faults, Ring, Subject};

/// Prints the name of each stage when it starts.
struct Printer;

impl Progress for Printer {
    fn on_stage_start(&self, stage: Stage) {
        println!("{} ...", stage.name());
    }

    fn step(&self, _: Stage, _: u32, _: u32) -> bool {
        // Returning false would cancel.
        true
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "reconstruction.glb".into());

    // The capture: calibrated cameras, and one photograph and one mask per camera.
    let cameras = Ring { count: 12, ..Ring::default() }.sized(320, 240).cameras();
    let capture = Capture::still(Subject::Figure, &cameras, &Faults::default());
    let shot = &capture.frames[0];
    println!("{} views of {} x {} pixels", cameras.len(), cameras[0].width, cameras[0].height);

    // The rig checks the calibration. It is shared by all frames.
    let rig = Rig::new(&capture.cameras)?;

    let start = Instant::now();
    let mut frame = Frame::new(&rig, Params::preset(Preset::Default), Memory::default());
    let inputs: Vec<ViewInput> = (0..cameras.len())
        .map(|i| ViewInput { image: shot.images[i].as_ref(), mask: shot.mask(i).map_or(Mask::Unknown, Mask::Given) })
        .collect();
    frame.run_all(&inputs, &Serial, &Printer)?;

    let counts = frame.counts();
    println!("{} points detected, {} placed on the hull", counts.detected, counts.substituted);
    println!("{} points merged", counts.merged);
    println!("{} vertices and {} triangles in {:.1?}", counts.vertices, counts.faces, start.elapsed());

    // The hashes are the same on every machine.
    for stage in ORDER {
        if let Some((_, hash)) = frame.hashes().iter().find(|(done, _)| *done == stage) {
            println!("{:>9} {hash:016x}", stage.name());
        }
    }

    let options = glb::Options { up: Some([0.0, 0.0, 1.0]), ..glb::Options::default() };
    fs::write(&path, glb::write(frame.mesh(), rig.origin(), &options))?;
    println!("wrote {path}");
    Ok(())
}
