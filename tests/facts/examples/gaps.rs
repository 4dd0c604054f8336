//! Longest time between two progress calls of each stage, in milliseconds: the fastest of three runs on a capture of 20
//! views of 1024 x 768. Fails if a stage exceeds the limit.
#![allow(clippy::disallowed_methods, reason = "no result depends on the example's own numbers")]

use facts::Shot;
use pcmvs_core::{Params, Preset, Progress, Serial, Stage, frame::ORDER, frame::position};
use std::{
    process::ExitCode,
    sync::Mutex,
    time::{Duration, Instant},
};
use studio::{Faults, Ring, Subject};

/// Limit for the time between two calls.
const LONGEST: Duration = Duration::from_millis(50);

/// Time of the last call, and the longest time between calls of each stage.
struct Silences(Mutex<(Instant, [Duration; ORDER.len()])>);

impl Silences {
    fn heard(&self, stage: Stage) {
        let mut state = self.0.lock().expect("no thread panics");
        let silence = state.0.elapsed();
        let longest = &mut state.1[position(stage)];
        *longest = silence.max(*longest);
        state.0 = Instant::now();
    }
}

impl Progress for Silences {
    fn on_stage_start(&self, stage: Stage) {
        self.heard(stage);
    }

    fn on_stage_end(&self, stage: Stage) {
        self.heard(stage);
    }

    fn step(&self, stage: Stage, _: u32, _: u32) -> bool {
        self.heard(stage);
        true
    }
}

fn main() -> ExitCode {
    let cameras = Ring { count: 20, distortion: [-0.1, 0.05, 0.001, -0.001, 0.0], ..Ring::default() };
    let shot = Shot::new(Subject::Figure, &cameras.sized(1024, 768).cameras(), &Faults::default());
    let params = Params::preset(Preset::Default);
    let mut fastest = [Duration::MAX; ORDER.len()];
    for _ in 0..3 {
        let silences = Silences(Mutex::new((Instant::now(), [Duration::ZERO; ORDER.len()])));
        shot.reconstruct_with(&params, &Serial, &silences).expect("the capture is complete");
        let (_, longest) = silences.0.into_inner().expect("no thread panics");
        for (fastest, longest) in fastest.iter_mut().zip(longest) {
            *fastest = longest.min(*fastest);
        }
    }
    for (stage, silence) in ORDER.into_iter().zip(fastest) {
        println!("{:9}{:7.1} ms", stage.name(), silence.as_secs_f64() * 1e3);
    }
    if fastest.iter().all(|&silence| silence <= LONGEST) { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
