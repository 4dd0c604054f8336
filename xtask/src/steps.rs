//! A run of checks: a line each, ending at the first that fails.

use crate::Result;
use std::{
    io::{Write, stdout},
    time::Instant,
};

/// How a check ended.
pub enum Outcome {
    /// It holds; what it measured, if anything.
    Passed(String),
    /// It could not be made, and why.
    Skipped(String),
}

/// What a check that measures nothing returns.
pub fn passed<T>(_: T) -> Outcome {
    Outcome::Passed(String::new())
}

/// Counts checks.
#[derive(Default)]
pub struct Steps {
    passed: u32,
    skipped: u32,
}

impl Steps {
    /// Makes a check. An error ends the run.
    pub fn step(&mut self, name: &str, check: impl FnOnce() -> Result<Outcome>) -> Result<()> {
        print!("{name:36}");
        // A line without its end is only for people who watch.
        let _ = stdout().flush();
        let start = Instant::now();
        let outcome = check();
        let seconds = start.elapsed().as_secs_f64();
        match outcome {
            Ok(Outcome::Passed(measured)) => {
                self.passed += 1;
                println!(" ok      {seconds:6.1} s  {measured}");
                Ok(())
            }
            Ok(Outcome::Skipped(why)) => {
                self.skipped += 1;
                println!(" skipped {seconds:6.1} s  {why}");
                Ok(())
            }
            Err(message) => {
                println!(" FAILED  {seconds:6.1} s\n{message}");
                println!("{} passed, 1 failed{}", self.passed, self.skips());
                Err(format!("{name} failed"))
            }
        }
    }

    /// The last line.
    pub fn finish(self) {
        println!("{} passed, 0 failed{}", self.passed, self.skips());
    }

    fn skips(&self) -> String {
        if self.skipped == 0 { String::new() } else { format!(", {} skipped", self.skipped) }
    }
}
