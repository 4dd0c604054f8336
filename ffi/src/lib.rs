//! `libpcmvs`: the core behind a C ABI. The reference manual is `include/pcmvs.h`, made from the comments here.
//!
//! A file is named after the C type it serves. [`boundary`], [`handles`] and [`sized`] hold what every function does at the
//! border: catch panics, check handles, pointers and struct sizes. [`work`] and [`take`] are safe Rust: the core's frame and
//! what the host has set for it, and the frames of a calibration.
#![allow(unsafe_code, reason = "the border to C; the core and everything else in the workspace have none")]
#![allow(non_camel_case_types, reason = "the names are C's")]
#![allow(clippy::missing_safety_doc, reason = "the header states once for all functions what a caller owes them")]

mod batches;
mod boundary;
mod clock;
mod compress;
mod executor;
mod failure;
mod handles;
mod locked;
mod plane;
mod progress;
mod sized;
#[cfg(feature = "allocator")]
mod spare;
mod take;
mod target;
mod text;
mod work;

// The header has them in this order, in which a user meets them.
pub mod version;

mod lost_part;
pub mod status;
mod steady;

pub mod stage;

#[cfg(feature = "allocator")]
pub mod allocator;

pub mod error;

pub mod camera;

pub mod rig;

pub mod pixel_format;

pub mod ycbcr;

pub mod image;

pub mod view;

pub mod options;

pub mod frame;

pub mod mesh;

pub mod cloud;

pub mod form;

pub mod export;

pub mod report;

pub mod warning;

pub mod calibration_options;

pub mod calibration;

pub mod calibration_report;
