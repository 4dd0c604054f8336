//! The program `golden`: reconstructs a capture and writes the outputs of all stages. It needs only the core and two files,
//! so that emulators can run it.

use golden::{CaptureFile, Detail, measure, preset};
use std::{env, fs, process::ExitCode};

const USAGE: &str =
    "usage: golden default|paper sample|all CAPTURE RECORD (`cargo xtask golden` makes captures and runs it)";

fn main() -> ExitCode {
    let arguments: Vec<String> = env::args().skip(1).collect();
    match run(&arguments.iter().map(String::as_str).collect::<Vec<_>>()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("golden: {problem}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &[&str]) -> Result<(), String> {
    let &[preset_name, detail, capture, path] = arguments else { return Err(USAGE.to_owned()) };
    let preset = preset(preset_name).ok_or(USAGE)?;
    let detail = match detail {
        "sample" => Detail::Sample,
        "all" => Detail::All,
        _ => return Err(USAGE.to_owned()),
    };
    let bytes = fs::read(capture).map_err(|e| format!("{capture}: {e}"))?;
    let file =
        CaptureFile::from_bytes(&bytes).ok_or_else(|| format!("{capture}: the file is truncated: write it again"))?;
    let record = measure(&file, preset, detail).map_err(|e| format!("{capture}: {e}"))?;
    fs::write(path, record.to_string()).map_err(|e| format!("{path}: {e}"))
}
