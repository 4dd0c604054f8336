//! Progress of a run: bars on a terminal, plain lines elsewhere.

use crate::warning::WarningReport;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use pcmvs_core::{Progress, Stage};
use std::{
    io::{IsTerminal, stderr},
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

/// The terminal or log that all frames share, and whether the user has cancelled.
pub struct Console<'a> {
    bars: Option<MultiProgress>,
    cancelled: &'a AtomicBool,
}

impl<'a> Console<'a> {
    pub fn new(cancelled: &'a AtomicBool) -> Self {
        Self { bars: stderr().is_terminal().then(MultiProgress::new), cancelled }
    }

    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Writes a line, above the bars if there are any.
    pub fn line(&self, text: &str) {
        // A closed terminal does not stop the run.
        match &self.bars {
            Some(bars) => drop(bars.println(text)),
            None => eprintln!("{text}"),
        }
    }

    /// Writes a warning.
    pub fn warn(&self, warning: &WarningReport) {
        self.line(&format!("warning: {}", warning.message));
    }

    /// Progress of one frame.
    pub fn frame(&self, index: u32) -> FrameProgress<'_> {
        let bar = self.bar(&format!("frame {index}"), 1);
        FrameProgress { console: self, index, bar, clocks: Mutex::default() }
    }

    /// A bar on the terminal, if there is one.
    pub fn bar(&self, name: &str, length: u64) -> ProgressBar {
        let Some(bars) = &self.bars else { return ProgressBar::hidden() };
        let style = ProgressStyle::with_template("{prefix} {msg:10} {bar:40} {pos}/{len} {elapsed}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        bars.add(ProgressBar::new(length).with_style(style).with_prefix(name.to_owned()))
    }
}

#[derive(Default)]
struct Clocks {
    running: Vec<(&'static str, Instant)>,
    /// In the order in which the steps first ended.
    seconds: Vec<(&'static str, f64)>,
}

/// Times and shows the stages of one frame.
pub struct FrameProgress<'a> {
    console: &'a Console<'a>,
    index: u32,
    bar: ProgressBar,
    clocks: Mutex<Clocks>,
}

impl FrameProgress<'_> {
    /// A stage of the core or a step of the host starts.
    pub fn begin(&self, name: &'static str) {
        self.bar.reset();
        self.bar.set_message(name);
        self.clocks().running.push((name, Instant::now()));
    }

    /// A step ends. Does nothing if it has not started.
    pub fn end(&self, name: &'static str) {
        let mut clocks = self.clocks();
        let Some(at) = clocks.running.iter().position(|&(running, _)| running == name) else { return };
        let seconds = clocks.running.remove(at).1.elapsed().as_secs_f64();
        match clocks.seconds.iter_mut().find(|(ended, _)| *ended == name) {
            Some((_, sum)) => *sum += seconds,
            None => clocks.seconds.push((name, seconds)),
        }
        drop(clocks);
        self.console.line(&format!("frame {} {name:8} {seconds:7.2} s", self.index));
    }

    /// Seconds of each finished step.
    pub fn seconds(&self) -> Vec<(&'static str, f64)> {
        self.clocks().seconds.clone()
    }

    fn clocks(&self) -> std::sync::MutexGuard<'_, Clocks> {
        self.clocks.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Progress for FrameProgress<'_> {
    fn on_stage_start(&self, stage: Stage) {
        self.begin(stage.name());
    }

    fn on_stage_end(&self, stage: Stage) {
        self.end(stage.name());
    }

    fn step(&self, _: Stage, done: u32, total: u32) -> bool {
        // Views finish in any order, but the bar must not run backwards.
        self.bar.set_length(u64::from(total));
        self.bar.set_position(self.bar.position().max(u64::from(done)));
        !self.console.is_cancelled()
    }
}

impl Drop for FrameProgress<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
