//! A frame made stage by stage is the frame made in one go, whatever is run twice, refused or recycled on the way.

use facts::{Shot, threads};
use pcmvs_core::{
    Error, ErrorCode, Frame, Memory, Params, Preset, Progress, Reconstruction, Rig, Serial, Silent, Stage,
    frame::{ORDER, Prior},
};
use std::sync::{Arc, LazyLock};
use studio::{Faults, Ring, Subject};

static SHOT: LazyLock<Shot> = LazyLock::new(|| {
    let cameras = Ring { count: 8, ..Ring::default() }.sized(160, 120).cameras();
    Shot::new(Subject::Torus, &cameras, &Faults::default())
});
static RIG: LazyLock<Rig> = LazyLock::new(|| SHOT.rig());

fn in_one_go(preset: Preset) -> Reconstruction {
    SHOT.reconstruct(&Params::preset(preset)).expect("nothing is wrong")
}

fn begun(preset: Preset, memory: Memory) -> Frame<&'static Rig> {
    Frame::new(&RIG, Params::preset(preset), memory)
}

fn read_views(frame: &Frame<&Rig>) {
    for (camera, input) in SHOT.inputs().iter().enumerate() {
        frame.view(camera, input, &Silent).expect("the studio's pictures are sound");
    }
}

fn assert_same(made: &Reconstruction, expected: &Reconstruction, what: &str) {
    assert_eq!(made.hashes, expected.hashes, "{what}");
    assert_eq!(made.counts, expected.counts, "{what}");
    assert_eq!(made.gains, expected.gains, "{what}");
}

/// Every stage is run twice, views and points come in falling order, and memory comes from an earlier frame.
#[test]
fn stages_may_run_again_and_memory_may_be_recycled() {
    for preset in [Preset::Default, Preset::Paper, Preset::Hull, Preset::Preview] {
        let expected = in_one_go(preset);
        let mut earlier = begun(Preset::Default, Memory::kept());
        earlier.run_all(&SHOT.inputs(), &Serial, &Silent).expect("nothing is wrong");
        let mut frame = begun(preset, earlier.recycle());
        for (camera, input) in SHOT.inputs().iter().enumerate().rev() {
            frame.view(camera, input, &Silent).expect("the studio's pictures are sound");
        }
        for stage in ORDER.into_iter().skip(1) {
            if stage == Stage::Detect {
                // Each on its own, as hosts with threads of their own do.
                for camera in (0..frame.cameras()).rev() {
                    frame.detect(camera, &Silent).expect("nothing is wrong");
                }
                continue;
            }
            frame.step(stage, &threads(2), &Silent).expect("nothing is wrong");
            frame.step(stage, &Serial, &Silent).expect("a stage may run again");
        }
        assert_same(&frame.into_reconstruction(), &expected, &format!("{preset:?}"));
    }
}

/// Going back to an early stage voids what came after it, and going on again gives the same result.
#[test]
fn going_back_counts_nothing_twice() {
    let expected = in_one_go(Preset::Paper);
    let mut frame = begun(Preset::Paper, Memory::kept());
    frame.run_all(&SHOT.inputs(), &Serial, &Silent).expect("nothing is wrong");
    frame.step(Stage::Contours, &Serial, &Silent).expect("nothing is wrong");
    assert_eq!(frame.require(Stage::Merge).map_err(|e| e.code()), Err(ErrorCode::WrongOrder));
    assert_eq!(frame.hashes().len(), 3, "results of later stages are void");
    for stage in ORDER.into_iter().skip(3) {
        frame.step(stage, &Serial, &Silent).expect("nothing is wrong");
    }
    assert_same(&frame.into_reconstruction(), &expected, "paper");
}

/// What comes too early or too late is refused, with the camera that is missing.
#[test]
fn wrong_order_is_refused() {
    let inputs = SHOT.inputs();
    let mut frame = begun(Preset::Default, Memory::default());
    let code = |result: Result<(), Error>| result.map_err(|error| (error.code(), error.camera()));
    frame.view(0, &inputs[0], &Silent).expect("the studio's pictures are sound");
    assert_eq!(code(frame.step(Stage::Hull, &Serial, &Silent)), Err((ErrorCode::WrongOrder, Some(1))));
    assert_eq!(code(frame.view(99, &inputs[0], &Silent)), Err((ErrorCode::InvalidArgument, Some(99))));
    assert_eq!(code(frame.detect(0, &Silent)), Err((ErrorCode::WrongOrder, Some(0))));
    read_views(&frame);
    assert_eq!(code(frame.step(Stage::Mesh, &Serial, &Silent)), Err((ErrorCode::WrongOrder, None)));
    for stage in [Stage::Hull, Stage::Contours, Stage::Coarse] {
        frame.step(stage, &Serial, &Silent).expect("nothing is wrong");
    }
    assert_eq!(code(frame.view(0, &inputs[0], &Silent)), Err((ErrorCode::WrongOrder, Some(0))));
    frame.detect(3, &Silent).expect("nothing is wrong");
    assert_eq!(code(frame.step(Stage::Merge, &Serial, &Silent)), Err((ErrorCode::WrongOrder, Some(0))));
    frame.step(Stage::Detect, &Serial, &Silent).expect("the other views are detected");
    assert_eq!(code(frame.detect(3, &Silent)), Err((ErrorCode::WrongOrder, Some(3))));
    assert_eq!(code(frame.run_all(&inputs[1..], &Serial, &Silent)), Err((ErrorCode::InvalidArgument, None)));
}

/// Refuses everything.
struct Refuse;

impl Progress for Refuse {
    fn step(&self, _: Stage, _: u32, _: u32) -> bool {
        false
    }
}

/// A cancelled stage can be run again. Before the hull is there, a view can still be replaced.
#[test]
fn a_cancelled_stage_can_run_again() {
    let expected = in_one_go(Preset::Default);
    let mut frame = begun(Preset::Default, Memory::default());
    read_views(&frame);
    for stage in ORDER.into_iter().skip(1) {
        assert_eq!(frame.step(stage, &Serial, &Refuse), Err(Error::Cancelled), "{stage:?}");
        if stage == Stage::Hull {
            frame.view(2, &SHOT.inputs()[2], &Silent).expect("the hull is not there yet");
        }
        frame.step(stage, &Serial, &Silent).expect("nothing is wrong");
    }
    assert_same(&frame.into_reconstruction(), &expected, "default");
}

/// The coarse pass's own mesh as prior gives what the coarse pass gives.
#[test]
fn a_prior_takes_the_place_of_the_coarse_pass() {
    let expected = in_one_go(Preset::Default);
    let mut params = Params::preset(Preset::Default);
    params.coarse = None;
    let mut frame = Frame::new(&*RIG, params, Memory::default());
    frame.set_prior(Prior { surface: Arc::new(expected.intermediates.coarse.clone()) });
    frame.run_all(&SHOT.inputs(), &Serial, &Silent).expect("nothing is wrong");
    assert_same(&frame.into_reconstruction(), &expected, "with a prior");
}

/// A frame that keeps no intermediate results makes the same mesh and says the same about its views. Stages whose inputs are
/// gone are refused until the stages before them have run again.
#[test]
fn a_frame_may_free_what_it_no_longer_needs() {
    for preset in [Preset::Default, Preset::Paper, Preset::Hull] {
        let expected = in_one_go(preset);
        let mut frame = begun(preset, Memory::default());
        frame.keep_intermediates(false);
        frame.keep_views(false);
        frame.run_all(&SHOT.inputs(), &threads(2), &Silent).expect("nothing is wrong");
        let pcmvs = preset != Preset::Hull;
        if pcmvs {
            let of = frame.intermediates();
            assert!(of.merged.is_empty() && of.frontier.is_empty() && of.detected.iter().all(Vec::is_empty));
            for stage in [Stage::Coarse, Stage::Detect, Stage::Merge, Stage::Mesh] {
                let refused = frame.step(stage, &Serial, &Silent).expect_err("its inputs are gone");
                assert_eq!(refused.code(), ErrorCode::WrongOrder, "{stage:?}");
            }
        }
        let refused = frame.step(Stage::Hull, &Serial, &Silent).expect_err("the views are cut");
        assert_eq!(refused.code(), ErrorCode::WrongOrder);
        let camera = RIG.cameras()[0];
        assert!(frame.views().iter().all(|view| view.luma.len() < (camera.width * camera.height) as usize));
        assert_eq!(frame.warnings(), expected.warnings);
        frame.step(Stage::Colour, &Serial, &Silent).expect("its inputs are there");
        for stage in ORDER.into_iter().skip(2) {
            frame.step(stage, &Serial, &Silent).expect("the stages before it have run again");
        }
        assert_same(&frame.into_reconstruction(), &expected, &format!("{preset:?}"));
    }
}
