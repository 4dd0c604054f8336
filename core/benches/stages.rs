//! Measures each stage separately, on one thread, with the default preset: `cargo bench`.
//!
//! The frame shows the studio's figure in 20 views of 320 x 240 pixels. Each stage runs repeatedly on the results of the
//! stages before it.

use criterion::{Criterion, criterion_group, criterion_main};
use pcmvs_core::{
    Error, Frame, Mask, Memory, Params, Preset, Rig, Serial, Silent, Stage, ViewInput, export::glb, frame::ORDER,
};
use std::hint::black_box;
use studio::{Capture, Faults, Ring, Subject};

const VIEWS: u32 = 20;
const SIZE: (u32, u32) = (320, 240);

fn bench(criterion: &mut Criterion) -> Result<(), Error> {
    let cameras = Ring { count: VIEWS, ..Ring::default() }.sized(SIZE.0, SIZE.1).cameras();
    let faults = Faults { noise: 1.5, gain: 0.04, ..Faults::default() };
    let capture = Capture::still(Subject::Figure, &cameras, &faults);
    let shot = &capture.frames[0];
    let mask = |i| shot.mask(i).map_or(Mask::Unknown, Mask::Given);
    let input = |i: usize| ViewInput { image: shot.images[i].as_ref(), mask: mask(i) };
    let inputs: Vec<ViewInput> = (0..cameras.len()).map(input).collect();
    let rig = Rig::new(&capture.cameras)?;

    let mut group = criterion.benchmark_group("stages");
    group.sample_size(10);
    let mut frame = Frame::new(&rig, Params::preset(Preset::Default), Memory::default());
    for stage in ORDER {
        if stage == Stage::Views {
            let mut views = || (0..inputs.len()).try_for_each(|i| frame.view(i, &inputs[i], &Silent));
            group.bench_function(stage.name(), |b| b.iter(&mut views));
            views()?;
            continue;
        }
        if stage == Stage::Detect {
            group.bench_function("detect, one view", |b| b.iter(|| frame.detect(black_box(0), &Silent)));
        }
        group.bench_function(stage.name(), |b| b.iter(|| frame.step(stage, &Serial, &Silent)));
        frame.step(stage, &Serial, &Silent)?;
    }
    group.bench_function("glb", |b| b.iter(|| glb::write(frame.mesh(), rig.origin(), &glb::Options::default())));
    group.finish();
    Ok(())
}

fn all(criterion: &mut Criterion) {
    bench(criterion).expect("the studio's capture can be reconstructed");
}

criterion_group!(benches, all);
criterion_main!(benches);
