//! The same bytes everywhere: what every stage gives for a few captures, and how that is compared.
//!
//! `golden.txt` has for every [`case`] the hash of each stage's output, how many numbers that is, and some of them.
//! `cargo xtask test` runs the program `golden`, which reads a capture and writes such a [`Record`], in several builds
//! and on several machines (`xtask/src/golden.rs`); `cargo xtask golden --renew` writes the file anew after a change
//! that is meant to change results.

mod capture_file;
#[cfg(feature = "studio")]
pub mod case;
mod difference;
pub mod file;
mod float;
mod measure;
mod record;

pub use capture_file::CaptureFile;
pub use difference::difference;
pub use measure::{measure, preset};
pub use record::{Array, Detail, Record, Stage};

/// What to do if results have changed and were meant to.
pub const RENEW: &str = "If results are meant to change: `cargo xtask golden --renew`, and commit tests/golden/golden.txt with the change.\n\
     If not, look for what changed in the first stage that differs.";
