//! `libpcmvs`: the core behind a C ABI. The reference manual is `include/pcmvs.h`, made from the comments here.
//!
//! A file is named after the C type it serves. [`boundary`] holds what every function does at the border: catch
//! panics, check handles, pointers and struct sizes. [`pipeline`] is safe Rust: a frame's stages and their order.
#![allow(unsafe_code, reason = "the border to C; the core and everything else in the workspace have none")]
#![allow(non_camel_case_types, reason = "the names are C's")]
#![allow(clippy::missing_safety_doc, reason = "the header states once for all functions what a caller owes them")]

mod boundary;
mod executor;
mod progress;

// The header has them in this order: that in which a user meets them.
pub mod version;

pub mod status;

#[cfg(feature = "allocator")]
pub mod allocator;

pub mod error;

pub mod camera;
mod clock;

pub mod rig;

pub mod image;

pub mod view;

pub mod options;

pub mod frame;

pub mod mesh;

pub mod cloud;

pub mod export;

pub mod report;
