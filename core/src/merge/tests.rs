//! Facts of §5.

mod conflict;
mod downsample;
