//! The command `pcmvs` as a function. It adds what the core leaves to its host: files, threads, clocks and the terminal.

mod arguments;
mod at_once;
mod calibration;
mod check;
mod fingerprint;
mod frame;
mod import;
mod join;
mod json;
mod kept;
mod lost_part;
mod manifest;
mod mesh_file;
mod neighbours;
mod output;
mod overrides;
mod pack;
mod progress;
mod reconstruct;
mod refine;
mod report;
mod run;
mod steps;
mod unchanged;
mod video;
mod warning;

pub use pcmvs_scene::Failure;

use arguments::{Arguments, Command};
use clap::Parser;
use std::{ffi::OsString, sync::atomic::AtomicBool};

/// Exit status of a check that found something doubtful.
const DOUBTFUL: u8 = 4;

/// Runs the command until it is done or `cancelled` becomes true. The first argument is the program's name. Returns the
/// exit status: 0 success, 1 other errors, 2 wrong usage or input, 3 cancelled, 4 a check found something doubtful.
/// Messages go to stderr.
pub fn run(arguments: impl IntoIterator<Item = OsString>, cancelled: &AtomicBool) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // clap returns help and version as errors whose exit code is 0. A closed terminal is not an error.
            let _ = error.print();
            return error.exit_code() as u8;
        }
    };
    let result = match arguments.command {
        Command::Reconstruct(options) => reconstruct::run(&options, cancelled).map(|()| 0),
        Command::Check(options) => check::run(&options, cancelled).map(|fine| if fine { 0 } else { DOUBTFUL }),
        Command::Refine(options) => refine::run(&options, cancelled).map(|()| 0),
        Command::Import(options) => import::run(&options).map(|()| 0),
        Command::Join(options) => join::run(&options, cancelled).map(|()| 0),
        Command::Pack(options) => pack::run(&options, cancelled).map(|()| 0),
    };
    match result {
        Ok(status) => status,
        Err(failure) => {
            eprintln!("error: {failure}");
            status(&failure)
        }
    }
}

/// Exit status of a failed command.
pub const fn status(failure: &Failure) -> u8 {
    match failure {
        Failure::Input(_) => 2,
        Failure::Cancelled => 3,
        Failure::Other(_) => 1,
    }
}
