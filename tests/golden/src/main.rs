//! The program `golden`: reconstructs a capture and prints what every stage gave. It needs nothing but the core, files
//! and a terminal, so that emulators can run it.

use golden::{Detail, Scene, measure};
use std::{env, fs, process::ExitCode};

const USAGE: &str = "usage: golden default|paper sample|all CAPTURE (`cargo xtask golden` makes captures and runs it)";

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(text) => {
            print!("{text}");
            ExitCode::SUCCESS
        }
        Err(problem) => {
            eprintln!("golden: {problem}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[&str]) -> Result<String, String> {
    let &[preset, detail, path] = arguments else { return Err(USAGE.to_owned()) };
    let preset = golden::preset(preset).ok_or(USAGE)?;
    let detail = match detail {
        "sample" => Detail::Sample,
        "all" => Detail::All,
        _ => return Err(USAGE.to_owned()),
    };
    let bytes = fs::read(path).map_err(|e| format!("{path}: {e}"))?;
    let scene = Scene::from_bytes(&bytes).ok_or_else(|| format!("{path}: is cut short: make it anew"))?;
    measure(&scene, preset, detail).map(|record| record.to_string()).map_err(|e| format!("{path}: {e}"))
}
