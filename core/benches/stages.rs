//! Times each stage alone, on one thread, with the default preset: `cargo bench`.
//!
//! A frame of the studio's figure, 20 views of 320 x 240: every stage runs again on what those before it gave.

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use pcmvs_core::{
    Counts, Error, Mask, Params, Preset, Rig, Serial, Silent, Stages, View, ViewInput, Workspace, colour::colour,
    detect::Scratch, export::glb, hull::VisualHull, stages,
};
use std::hint::black_box;
use studio::{Capture, Faults, Ring, Subject};

const VIEWS: u32 = 20;
const SIZE: (u32, u32) = (320, 240);

fn bench(criterion: &mut Criterion) -> Result<(), Error> {
    let cameras = Ring { count: VIEWS, ..Ring::default() }.sized(SIZE.0, SIZE.1).cameras();
    let faults = Faults { noise: 1.5, gain: 0.04, ..Faults::default() };
    let capture = Capture::still(Subject::Figure, &cameras, &faults);
    let frame = &capture.frames[0];
    let mask = |i| frame.mask(i).map_or(Mask::Unknown, Mask::Given);
    let input = |i: usize| ViewInput { image: frame.images[i].as_ref(), mask: mask(i) };
    let inputs: Vec<ViewInput> = (0..cameras.len()).map(input).collect();
    let rig = Rig::new(&capture.cameras)?;
    let params = Params::preset(Preset::Default);

    let mut group = criterion.benchmark_group("stages");
    group.sample_size(10);

    let views = || -> Result<Vec<View>, Error> { (0..inputs.len()).map(|i| View::new(&rig, i, &inputs[i])).collect() };
    group.bench_function("views", |b| b.iter(views));
    let views = views()?;

    let hull = || VisualHull::new(&views, &params.hull, &Silent);
    group.bench_function("hull", |b| {
        b.iter(|| hull().map(|hull| stages::hull_mesh(&hull, &params, &mut Workspace::default())))
    });
    let hull = hull()?;

    let mut made = Stages { hull: stages::hull_mesh(&hull, &params, &mut Workspace::default()).0, ..Stages::default() };
    let contours = || -> Result<_, Error> {
        let frontier = views.iter().flat_map(|view| stages::frontier(view, &hull, &params)).collect();
        Ok((frontier, stages::implicit(&made.hull, &views, &params, &Silent)?))
    };
    group.bench_function("contours", |b| b.iter(contours));
    (made.frontier, made.implicit) = contours()?;

    let coarse = |scratch: &mut _| {
        stages::coarse(
            &rig,
            &views,
            &made.hull,
            &made.frontier,
            &hull,
            &params,
            &Serial,
            (scratch, &mut Workspace::default()),
            &Silent,
        )
    };
    let mut scratch = Vec::new();
    group.bench_function("coarse", |b| b.iter(|| coarse(&mut scratch)));
    made.coarse = coarse(&mut scratch)?;

    let levels = stages::levels(&views, &params, &Serial);
    let detect = |view, scratch: &mut _| {
        stages::detect(&rig, view, &levels, &hull, &made.hull, &made.coarse, &params, scratch, &Silent)
    };
    let mut scratch = Scratch::default();
    group.bench_function("detect, one view", |b| b.iter(|| detect(black_box(0), &mut scratch)));
    made.detected = (0..views.len()).map(|view| Ok(detect(view, &mut scratch)?.0)).collect::<Result<_, Error>>()?;

    let merge =
        || stages::merge(&made, &views, &hull, &params, &mut Counts::default(), &mut Workspace::default(), &Silent);
    group.bench_function("merge", |b| b.iter(merge));
    made.merged = merge()?;

    let mesh = || stages::mesh(&made.merged, &hull, &params, &mut Workspace::default(), &Silent);
    group.bench_function("mesh", |b| b.iter(mesh));
    let mut mesh = mesh()?.mesh;

    group.bench_function("colour", |b| {
        let coloured =
            |mesh: &mut _| colour(mesh, &views, rig.gains(), &params.colour, &mut Workspace::default(), &Silent);
        b.iter_batched_ref(|| mesh.clone(), coloured, BatchSize::LargeInput);
    });
    colour(&mut mesh, &views, rig.gains(), &params.colour, &mut Workspace::default(), &Silent)?;

    group.bench_function("glb", |b| b.iter(|| glb::write(&mesh, rig.origin(), &glb::Options::default())));
    group.finish();
    Ok(())
}

fn all(criterion: &mut Criterion) {
    bench(criterion).expect("the studio's capture is sound");
}

criterion_group!(benches, all);
criterion_main!(benches);
