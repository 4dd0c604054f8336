//! Point cloud detection (§4.1 to §4.3), one view at a time.
//!
//! `range` sets the depth interval of each pixel, `sweep` correlates windows with the neighbouring views (§4.1), `vote`
//! selects the depth with the most support (eq. 1), `substitute` replaces failed depths (§4.2) and `clean` removes
//! outliers (§4.3).

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
