//! Progress is consistent, and the host can cancel at any step.

use facts::{Shot, threads};
use pcmvs_core::{Error, Params, Preset, Progress, Serial, Silent, Stage, frame::position};
use std::sync::{
    LazyLock, Mutex,
    atomic::{AtomicU32, Ordering},
};
use studio::{Faults, Ring, Subject};

static SHOT: LazyLock<Shot> = LazyLock::new(|| {
    let cameras = Ring { count: 6, ..Ring::default() }.sized(120, 90).cameras();
    Shot::new(Subject::Torus, &cameras, &Faults::default())
});

/// Refuses exactly one step.
struct StopAt {
    step: u32,
    steps: AtomicU32,
}

impl StopAt {
    fn new(step: u32) -> Self {
        Self { step, steps: AtomicU32::new(0) }
    }
}

impl Progress for StopAt {
    fn step(&self, _: Stage, _: u32, _: u32) -> bool {
        self.steps.fetch_add(1, Ordering::Relaxed) != self.step
    }
}

/// Refusing any step gives `Cancelled`, and the next run is not affected.
#[test]
fn every_step_can_cancel() {
    for preset in [Preset::Default, Preset::Paper, Preset::Hull] {
        let params = Params::preset(preset);
        let counting = StopAt::new(u32::MAX);
        let before = SHOT.reconstruct_with(&params, &Serial, &counting).expect("nothing stops it");
        let steps = counting.steps.into_inner();
        let stride = (steps / 25).max(1) as usize;
        for step in (0..steps).step_by(stride).chain([steps - 1]) {
            let stopped = SHOT.reconstruct_with(&params, &Serial, &StopAt::new(step));
            assert_eq!(stopped.err(), Some(Error::Cancelled), "{preset:?}: step {step} of {steps}");
        }
        let stopped = SHOT.reconstruct_with(&params, &threads(2), &StopAt::new(steps / 2));
        assert_eq!(stopped.err(), Some(Error::Cancelled), "{preset:?}");
        let after = SHOT.reconstruct_with(&params, &Serial, &Silent).expect("nothing stops it");
        assert_eq!(before.hashes, after.hashes);
    }
}

#[derive(Default)]
struct Log(Mutex<Vec<Event>>);

#[derive(Debug, Clone, Copy)]
enum Event {
    Mark(Stage, bool),
    Step(Stage, u32, u32),
}

impl Progress for Log {
    fn on_stage_start(&self, stage: Stage) {
        self.0.lock().unwrap().push(Event::Mark(stage, true));
    }

    fn on_stage_end(&self, stage: Stage) {
        self.0.lock().unwrap().push(Event::Mark(stage, false));
    }

    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        self.0.lock().unwrap().push(Event::Step(stage, done, total));
        true
    }
}

/// Stages follow their order, and progress within a stage neither decreases nor exceeds its total.
#[test]
fn progress_goes_forward() {
    for preset in [Preset::Default, Preset::Paper, Preset::Hull] {
        let log = Log::default();
        SHOT.reconstruct_with(&Params::preset(preset), &Serial, &log).expect("nothing stops it");
        let (mut running, mut last, mut share) = (None, None, 0.0);
        for event in log.0.into_inner().unwrap() {
            match event {
                Event::Mark(stage, true) => {
                    assert_eq!(running, None, "{preset:?}: {stage:?} begins inside another");
                    assert!(last.map(position) < Some(position(stage)), "{preset:?}: {stage:?} after {last:?}");
                    (running, last, share) = (Some(stage), Some(stage), 0.0);
                }
                Event::Mark(stage, false) => {
                    assert_eq!(running, Some(stage), "{preset:?}");
                    running = None;
                }
                Event::Step(stage, done, total) => {
                    assert_eq!(running, Some(stage), "{preset:?}: a step of {stage:?}");
                    assert!(total > 0 && done <= total, "{preset:?}: {stage:?} {done} of {total}");
                    let now = f64::from(done) / f64::from(total);
                    assert!(now >= share, "{preset:?}: {stage:?} goes back from {share} to {done} of {total}");
                    share = now;
                }
            }
        }
        assert_eq!((running, last), (None, Some(Stage::Colour)), "{preset:?}");
    }
}
