//! The memory need of a frame is known before the memory is allocated.

use facts::{Shot, counting::peak_of};
use pcmvs_core::{
    Error, FormParams, Frame, ImageRef, Lens, Mask, Memory, Mesh, Params, PixelFormat, Preset, Progress, Serial,
    Silent, Stage, TextureParams, View, ViewInput, hull::VisualHull, memory,
};
use std::sync::Mutex;
use studio::{Faults, Ring, Subject};

/// The last stage that started.
#[derive(Default)]
struct Last(Mutex<Option<Stage>>);

impl Progress for Last {
    fn on_stage_start(&self, stage: Stage) {
        *self.0.lock().unwrap() = Some(stage);
    }

    fn step(&self, _: Stage, _: u32, _: u32) -> bool {
        true
    }
}

/// The formula is an upper bound, and less than twice the peak where pictures take more memory than the search for the
/// hull. With exactly the needed limit a frame succeeds; with one byte less it is refused before detection starts.
fn takes_what_the_formula_says(count: u32, (width, height): (u32, u32)) {
    let cameras = Ring { count, ..Ring::default() }.sized(width, height).cameras();
    let shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
    let rig = shot.rig();
    let inputs = shot.inputs();
    for preset in [Preset::Default, Preset::Paper, Preset::Hull, Preset::Preview] {
        let params = Params::preset(preset);
        let mut hull = Mesh::default();
        let (_, taken) = peak_of(|| hull = shot.reconstruct(&params).expect("nothing is wrong").intermediates.hull);
        let read = |i: usize| View::at(&rig, i, &inputs[i], params.contour.as_ref(), &params.reading);
        let view = |i: usize| read(i).expect("nothing is wrong");
        let views: Vec<View> = (0..inputs.len()).map(view).collect();
        let carved = VisualHull::new(&views, &params.hull, &Silent).expect("there is a hull");
        let needed = memory::needed(&views, &carved, &hull, &params, false);
        assert!(taken <= needed, "{preset:?}, {count} x {width}: {taken} bytes allocated, {needed} predicted");
        // Pictures that are read at half the resolution may have to be keyed in full resolution before.
        let is_tight = width >= 320 && params.reading.octave == 0;
        assert!(!is_tight || needed < 2 * taken, "{preset:?}, {count} x {width}: {taken} of {needed}");

        let within = |limit: u64, progress: &dyn Progress| {
            let mut frame = Frame::new(&rig, params, Memory::limited(limit));
            frame.keep_views(false);
            frame.run_all(&shot.inputs(), &Serial, progress)
        };
        let last = Last::default();
        let refused = within(needed - 1, &last).err();
        assert_eq!(refused, Some(Error::OutOfMemory { needed, limit: needed - 1 }));
        // A limit below the need of any frame of the rig is refused at once.
        let begun = (needed > memory::smallest(&rig, &params)).then_some(Stage::Hull);
        assert_eq!(last.0.into_inner().unwrap(), begun, "{preset:?}, {count} x {width}");
        assert!(within(needed, &Silent).is_ok());
        let mut refused = None;
        let (_, taken) = peak_of(|| refused = within(memory::smallest(&rig, &params) - 1, &Silent).err());
        assert!(matches!(refused, Some(Error::OutOfMemory { .. })));
        assert!(taken < 1 << 20, "{taken} bytes allocated before the refusal");
    }
}

#[test]
fn small_pictures_take_what_the_formula_says() {
    takes_what_the_formula_says(8, (160, 120));
}

#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn many_views_take_what_the_formula_says() {
    takes_what_the_formula_says(40, (320, 240));
}

#[test]
fn few_views_take_what_the_formula_says() {
    takes_what_the_formula_says(5, (640, 480));
}

#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn larger_pictures_take_what_the_formula_says() {
    takes_what_the_formula_says(10, (640, 480));
}

/// A form takes at most what the formula says besides its frame, and is refused with a limit that is too small.
#[test]
fn a_form_takes_what_the_formula_says() {
    let cameras = Ring { count: 8, ..Ring::default() }.sized(480, 360).cameras();
    let shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
    let rig = shot.rig();
    let params = Params::preset(Preset::Hull);
    let finished = |memory: Memory| {
        let mut frame = Frame::new(&rig, params, memory);
        frame.run_all(&shot.inputs(), &Serial, &Silent).expect("nothing is wrong");
        frame
    };
    let frame = finished(Memory::default());
    for (faces, size) in [(Some(2000), 0), (None, 512), (None, 2048), (Some(2000), 1024)] {
        let texture = (size > 0).then_some(TextureParams { size: Some(size) });
        let form = FormParams { faces, texture };
        let (_, taken) = peak_of(|| drop(frame.form(&form, &Serial, &Silent).expect("nothing is wrong")));
        let needed = memory::form(frame.views(), frame.mesh(), size);
        println!("{faces:?}, {size}: {taken} bytes allocated, {needed} predicted");
        assert!(taken <= needed, "{faces:?}, {size}: {taken} bytes allocated, {needed} predicted");
    }
    let hull = frame.hull().expect("it is carved");
    let needed = memory::needed(frame.views(), hull, &frame.intermediates().hull, &params, true);
    let limited = finished(Memory::limited(needed));
    let form = FormParams { texture: Some(TextureParams::default()), ..FormParams::default() };
    let refused = limited.form(&form, &Serial, &Silent).map(drop);
    assert!(matches!(refused, Err(Error::OutOfMemory { limit, .. }) if limit == needed), "{refused:?}");
}

/// A frame of 20 views of 1024 x 768 stays below 400 MiB.
#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn a_usual_frame_takes_less_than_400_mib() {
    let cameras = Ring::default().sized(1024, 768).cameras();
    let shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
    let (_, taken) = peak_of(|| drop(shot.reconstruct(&Params::preset(Preset::Default)).expect("nothing is wrong")));
    println!("{} MiB", taken >> 20);
    assert!(taken < 400 << 20);
}

/// Reading the views takes at most what every frame needs: even if large pictures are distorted, or if a matte has nearly
/// as much contour as is still refined.
#[test]
#[ignore = "takes long: `cargo xtask test --all` runs it"]
fn reading_views_takes_no_more_than_the_smallest_frame() {
    let (width, height) = (1024, 768);
    let cameras = Ring { count: 3, ..Ring::default() }.sized(width, height).cameras();
    let stripes: Vec<u8> = (0..width * height).map(|i| if i % width / 7 % 2 == 0 { 255 } else { 90 }).collect();
    let plain = vec![90; stripes.len()];
    for distorted in [false, true] {
        let mut cameras = cameras.clone();
        cameras.iter_mut().for_each(|c| c.lens = Lens::brown([if distorted { -0.1 } else { 0.0 }, 0.0, 0.0, 0.0, 0.0]));
        let shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
        let rig = shot.rig();
        let params = Params::preset(Preset::Default);
        let gray = |bytes| ImageRef::packed(bytes, width, height, PixelFormat::Gray8);
        let given = ViewInput { image: gray(&plain), mask: Mask::Given(gray(&stripes)) };
        let plate = ViewInput { image: gray(&stripes), mask: Mask::CleanPlate(gray(&plain)) };
        for (name, inputs) in [("figure", shot.inputs()), ("given", vec![given; 3]), ("plate", vec![plate; 3])] {
            let contour = params.contour.as_ref();
            let view = View::new(&rig, 0, &inputs[0], contour).expect("nothing is wrong");
            let silhouette = view.silhouette.expect("there is a mask");
            let refined = (0..width).any(|x| silhouette.contour_sigma(x as f32, 400.0).is_some());
            assert!(refined, "the matte was taken for noise");
            let (_, taken) = peak_of(|| {
                let frame = Frame::new(&rig, params, Memory::default());
                for (i, input) in inputs.iter().enumerate() {
                    frame.view(i, input, &Silent).expect("nothing is wrong");
                }
            });
            let pixels = u64::from(width * height);
            println!(
                "{name}, distorted {distorted}: {} bytes per pixel of a view",
                (taken - 18 * pixels) as f32 / pixels as f32
            );
            assert!(taken <= memory::smallest(&rig, &params), "{name}, distorted {distorted}: {taken} bytes allocated");
        }
    }
}

/// Reading views together with those of the frames before and after takes at most what the formula says, whether masks lack a
/// part or have nearly as much contour as is still refined. A smaller limit is refused.
#[test]
fn reading_views_between_others_takes_what_the_formula_says() {
    let (width, height) = (640, 480);
    let cameras = Ring { count: 3, ..Ring::default() }.sized(width, height).cameras();
    let shot = Shot::new(Subject::Figure, &cameras, &Faults::default());
    let (rig, params) = (shot.rig(), Params::preset(Preset::Default));
    let mut lacking = shot.clone();
    for mask in lacking.frame.masks.iter_mut().flatten() {
        let inside = mask.iter().position(|&v| v > 127).expect("the figure is in the picture");
        mask[..inside + 80 * width as usize].fill(0);
    }
    let stripes: Vec<u8> = (0..width * height).map(|i| if i % width / 7 % 2 == 0 { 255 } else { 90 }).collect();
    let plain = vec![90; stripes.len()];
    let gray = |bytes| ImageRef::packed(bytes, width, height, PixelFormat::Gray8);
    let striped = vec![ViewInput { image: gray(&plain), mask: Mask::Given(gray(&stripes)) }; 3];
    let read = |memory: Memory, inputs: &[ViewInput], beside: &[ViewInput]| {
        let frame = Frame::new(&rig, params, memory);
        frame.read_views_between::<Error>(&Serial, &Silent, |camera, give| {
            give(Some(&inputs[camera]), [Some(&beside[camera]); 2])
        })
    };
    let needed = memory::smallest(&rig, &params) + memory::between(&rig, &params);
    for (name, inputs, beside, cameras) in
        [("lacking", lacking.inputs(), shot.inputs(), 3), ("striped", striped.clone(), striped, 0)]
    {
        let mut restored = Ok(0);
        let (_, taken) = peak_of(|| restored = read(Memory::default(), &inputs, &beside));
        let per_pixel = (taken as f32 - 18.0 * plain.len() as f32) / plain.len() as f32;
        println!("{name}: {per_pixel} bytes per pixel of a view besides the views");
        assert_eq!(restored, Ok(cameras), "{name}");
        assert!(taken <= needed, "{name}: {taken} bytes allocated, {needed} predicted");
        let refused = read(Memory::limited(needed - 1), &inputs, &beside);
        assert_eq!(refused, Err(Error::OutOfMemory { needed, limit: needed - 1 }));
        assert_eq!(read(Memory::limited(needed), &inputs, &beside), restored);
    }
}
