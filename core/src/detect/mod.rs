//! Point cloud detection (§4), one view at a time.

pub mod depth;
pub mod level;
pub mod neighbours;
pub mod range;
pub mod sweep;
pub mod vote;
