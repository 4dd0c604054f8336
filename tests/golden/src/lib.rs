//! Golden results: the outputs of every stage for a few captures, which must be the same bytes on every machine.
//!
//! `golden.txt` contains, for every [`case`], the hash of each stage's output, the number of its values, and some of them.
//! `cargo xtask test` runs the program `golden`, which reads a capture and writes such a [`Record`], in several builds
//! and on several machines (`xtask/src/golden.rs`). `cargo xtask golden --renew` writes a new file after a change that is
//! meant to change results.

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

/// Advice if results have changed.
pub const RENEW: &str = "If results are meant to change, run `cargo xtask golden --renew` and commit tests/golden/golden.txt with the change.\n\
     If not, look for the cause in the first stage that differs.";
