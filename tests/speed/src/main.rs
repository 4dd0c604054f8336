//! Reconstructs a frame on one thread with the default preset and prints the time of each stage.
//!
//! `speed CAPTURE ROUNDS`: the capture is a `golden::CaptureFile`. Prints one line per stage with its name and the seconds
//! of every round, then `frame` with the seconds of the whole reconstruction, and `hash` with the hash of the coloured
//! mesh. Under callgrind, [`boundary`] marks the start and the end of stages, and [`jobs::all`] what an executor's threads
//! would share.
//!
//! `speed CAPTURE schedule` prints the seconds that a frame takes with 1, 2, 4, 8 and 16 threads if they never wait for
//! memory: the jobs are timed on one thread, and [`jobs::Timed::seconds`] distributes them.

mod jobs;

use golden::CaptureFile;
use jobs::{Marked, Timed};
use pcmvs_core::{Error, Params, Preset, Progress, Rig, Silent, Stage, export::glb, reconstruct};
use std::{
    env, error, fs,
    hint::black_box,
    sync::{Mutex, PoisonError},
    time::Instant,
};

/// callgrind dumps its counters when this function is called, so it must not be inlined.
#[inline(never)]
fn boundary(now: Instant) -> Instant {
    black_box(now)
}

/// Seconds by name, in the order of measurement.
type Seconds = Vec<(&'static str, f64)>;

/// Measures the time of each stage.
#[derive(Default)]
struct Clock(Mutex<(Option<Instant>, Seconds)>);

impl Clock {
    fn tick(&self, name: &'static str, begin: bool) {
        let (begun, seconds) = &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let now = boundary(Instant::now());
        match begun.take() {
            Some(begun) if !begin => seconds.push((name, (now - begun).as_secs_f64())),
            _ => *begun = Some(now),
        }
    }
}

impl Progress for Clock {
    fn on_stage_start(&self, stage: Stage) {
        self.tick(stage.name(), true);
    }

    fn on_stage_end(&self, stage: Stage) {
        self.tick(stage.name(), false);
    }

    fn step(&self, _: Stage, _: u32, _: u32) -> bool {
        true
    }
}

/// Seconds of one round and the mesh's hash.
fn round(rig: &Rig, capture: &CaptureFile) -> Result<(Seconds, u64), Error> {
    let (clock, inputs) = (Clock::default(), capture.inputs());
    let start = Instant::now();
    let result = reconstruct(rig, &inputs, &Params::preset(Preset::Default), &Marked, &clock)?;
    let frame = start.elapsed().as_secs_f64();
    clock.tick("glb", true);
    black_box(glb::write(&result.mesh, rig.origin(), &glb::Options::default()));
    clock.tick("glb", false);
    let (_, mut seconds) = clock.0.into_inner().unwrap_or_else(PoisonError::into_inner);
    seconds.push(("frame", frame));
    Ok((seconds, result.mesh.hash()))
}

/// Prints the seconds for each number of threads.
fn schedule(rig: &Rig, capture: &CaptureFile) -> Result<(), Error> {
    let timed = Timed::default();
    let start = Instant::now();
    reconstruct(rig, &capture.inputs(), &Params::preset(Preset::Default), &timed, &Silent)?;
    let whole = start.elapsed().as_secs_f64();
    for threads in [1, 2, 4, 8, 16] {
        println!("{threads} {}", timed.seconds(whole, threads));
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn error::Error>> {
    let arguments: Vec<String> = env::args().collect();
    let [_, capture, rounds] = arguments.as_slice() else {
        return Err("usage: speed CAPTURE ROUNDS, or speed CAPTURE schedule".into());
    };
    let capture = CaptureFile::from_bytes(&fs::read(capture)?).ok_or("the capture is truncated")?;
    let rig = Rig::new(&capture.cameras)?;
    if rounds == "schedule" {
        return Ok(schedule(&rig, &capture)?);
    }
    let rounds = (0..rounds.parse()?).map(|_| round(&rig, &capture)).collect::<Result<Vec<_>, _>>()?;
    let (first, hash) = rounds.first().ok_or("ROUNDS must be at least 1")?;
    for (i, (name, _)) in first.iter().enumerate() {
        let seconds: Vec<String> = rounds.iter().map(|(seconds, _)| seconds[i].1.to_string()).collect();
        println!("{name} {}", seconds.join(" "));
    }
    println!("hash {hash:016x}");
    Ok(())
}
