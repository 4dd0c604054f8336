//! Tests of the command line. They are one program, because each would be linked with the whole library.
#![allow(clippy::disallowed_methods, reason = "no result depends on the tests' own numbers")]

mod common;

mod bad_input;
mod calibration;
mod exports;
mod forms;
mod import;
mod join;
mod pack;
mod publish;
mod reconstruct;
mod take;
mod video;
mod warnings;
