//! Point cloud detection (§4.1 to §4.3), one view at a time.

mod clean;
mod depth;
mod detect_view;
mod level;
mod range;
mod substitute;
mod sweep;
mod vote;

pub use clean::CleanParams;
pub use depth::{SearchParams, Windows};
pub use detect_view::{DetectionParams, DetectionScratch, Guide, detect_view};
pub use level::PyramidLevel;
pub use substitute::SubstitutionParams;
pub use vote::{Support, VoteParams};

#[cfg(test)]
mod tests;
