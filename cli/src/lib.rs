//! The command `pcmvs` as a function: captures in, meshes out. All that the core leaves to its host is here: files,
//! threads, clocks, the terminal.

mod arguments;

mod fingerprint;
mod frame;
mod import;
mod json;
mod output;
mod overrides;
mod progress;
mod reconstruct;
mod report;
mod threads;

pub use pcmvs_scene::Failure;

use arguments::{Arguments, Command};
use clap::Parser;
use std::{ffi::OsString, sync::atomic::AtomicBool};

/// Runs the command with its arguments (the first is the program's name) until it is done or `cancelled` becomes true.
/// Returns the exit status: 0 ok, 2 bad usage or input, 3 cancelled, 1 anything else. Messages go to stderr.
pub fn run(arguments: impl IntoIterator<Item = OsString>, cancelled: &AtomicBool) -> u8 {
    let arguments = match Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version come as errors too, but end with 0. Nobody is left to tell when the terminal is gone.
            let _ = error.print();
            return error.exit_code() as u8;
        }
    };
    let result = match arguments.command {
        Command::Reconstruct(options) => reconstruct::run(&options, cancelled),
        Command::Import(options) => import::run(&options),
    };
    match result {
        Ok(()) => 0,
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
