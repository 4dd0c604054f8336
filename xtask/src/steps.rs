//! A run of checks: one line each, ending at the first that fails.

use crate::{
    Result,
    process::{cargo, run},
    setup::{Need, missing},
};
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
pub struct Steps {
    /// Whether checks may install what they need.
    install: bool,
    passed: u32,
    skipped: u32,
}

impl Default for Steps {
    fn default() -> Self {
        Self::new(true)
    }
}

impl Steps {
    /// Without `install`, checks that need something missing are skipped.
    pub fn new(install: bool) -> Self {
        Self { install, passed: 0, skipped: 0 }
    }

    /// Makes some checks outside of the test command.
    pub fn alone(needs: &[Need], checks: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        let mut steps = Self::new(true);
        steps.announce(needs);
        checks(&mut steps)?;
        steps.finish();
        Ok(())
    }

    /// The commands that some checks run, which the test command has built with its tests.
    pub fn build_commands(&mut self) -> Result<()> {
        let build = || run(&mut cargo("build --quiet -p pcmvs-cli -p studio --bins"));
        self.step("command and studio", || build().map(passed))
    }

    /// Reports what checks need and this machine lacks, before the first of them installs anything.
    pub fn announce(&self, needs: &[Need]) {
        let lacking = missing(needs);
        if lacking.is_empty() {
            return;
        }
        println!("Missing on this machine:");
        lacking.iter().for_each(|remedy| println!("  {remedy}"));
        println!(
            "{}\n",
            if self.install {
                "The checks that need them install them."
            } else {
                "The checks that need them are skipped."
            }
        );
    }

    /// Makes a check that needs nothing besides the toolchain. An error ends the run.
    pub fn step(&mut self, name: &str, check: impl FnOnce() -> Result<Outcome>) -> Result<()> {
        self.step_with(&[], name, check)
    }

    /// Makes a check that installs what it needs, or skips it.
    pub fn step_with(&mut self, needs: &[Need], name: &str, check: impl FnOnce() -> Result<Outcome>) -> Result<()> {
        print!("{name:36}");
        // A line without its end is only for people who watch.
        let _ = stdout().flush();
        let start = Instant::now();
        let lacking = if self.install { Vec::new() } else { missing(needs) };
        let outcome = if lacking.is_empty() {
            check()
        } else {
            Ok(Outcome::Skipped(format!("something is missing: {}", lacking.join("; "))))
        };
        let seconds = start.elapsed().as_secs_f64();
        match outcome {
            Ok(Outcome::Passed(measured)) => {
                self.passed += 1;
                println!(" ok      {seconds:6.1} s  {measured}");
                Ok(())
            }
            Ok(Outcome::Skipped(why)) => {
                self.skipped += 1;
                println!(" SKIPPED {seconds:6.1} s  {why}");
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
