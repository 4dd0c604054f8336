//! The command `pcmvs`.

use std::{
    process::{ExitCode, exit},
    sync::atomic::{AtomicBool, Ordering},
};

/// Set by the first Ctrl-C or SIGTERM. The second one ends the program at once.
static CANCELLED: AtomicBool = AtomicBool::new(false);

fn main() -> ExitCode {
    let handler = || {
        if CANCELLED.swap(true, Ordering::Relaxed) {
            exit(i32::from(pcmvs_cli::status(&pcmvs_cli::Failure::Cancelled)));
        }
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        eprintln!("warning: Ctrl-C will kill this run instead of ending it: {error}");
    }
    ExitCode::from(pcmvs_cli::run(std::env::args_os(), &CANCELLED))
}
