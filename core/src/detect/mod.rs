//! Point cloud detection (§4), one view at a time.

pub mod clean;
pub mod depth;
pub mod frontier;
pub mod level;
pub mod neighbours;
pub mod range;
pub mod sweep;
pub mod vote;
