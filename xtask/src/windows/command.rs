//! The command line: its files, paths as Windows writes them, and Ctrl-C.

use super::machine::{CC, built, compare, empty, prefix, windows_path, wine};
use crate::{
    Result,
    abi::problem,
    process::{program, root, run, target},
    sample,
};
use std::{
    fmt::Write,
    fs,
    path::{Path, PathBuf},
};
use studio::{Capture, Faults, Ring, Subject};

/// Options of the command line for the compared files, besides the default.
const WEB: &str = "--faces 5000 --texture=256 --compress --upright";

pub fn check() -> Result<String> {
    forms()?;
    import()?;
    interrupt()?;
    Ok(String::from("2 forms, an imported scene, Ctrl-C"))
}

fn pcmvs() -> PathBuf {
    target().join("release/pcmvs")
}

/// The sample's first frame, with the average over its neighbours in the take, has the same bytes.
fn forms() -> Result<()> {
    let scene = root().join("web/public/sample");
    sample::make(&scene)?;
    for options in ["", WEB] {
        let files = empty("forms")?;
        let options = format!("reconstruct --frames 0 {options}");
        let (here, there) = (files.join("here"), files.join("there"));
        run(program(pcmvs(), &options).arg(&scene).arg("-o").arg(&here))?;
        let mut command = wine(&built().join("pcmvs.exe"))?;
        command.args(options.split_whitespace()).arg(windows_path(&scene)).arg("-o").arg(windows_path(&there));
        run(&mut command)?;
        for name in ["frame_0000.glb", "sequence.json"] {
            compare(&here.join(name), &there.join(name))?;
        }
    }
    Ok(())
}

/// A calibration whose names have backslashes, spaces and letters that are not ASCII becomes the same scene on both systems,
/// with `/` in its paths. It is written to drive C:, and read again from there.
fn import() -> Result<()> {
    let source = empty("import")?;
    calibrated(&source.join("Kameras ä"), 1)?;
    let drive = prefix().join("drive_c").join("Szene ö");
    if drive.exists() {
        fs::remove_dir_all(&drive).map_err(problem(&drive))?;
    }
    let here = source.join("here");
    run(program(pcmvs(), "import --from middlebury").arg(source.join("Kameras ä")).arg("-o").arg(&here))?;
    let mut command = wine(&built().join("pcmvs.exe"))?;
    // A path below the working directory.
    command.current_dir(&source).args(["import", "--from", "middlebury", r".\Kameras ä", "-o", r"C:\Szene ö"]);
    run(&mut command)?;
    compare(&here.join("scene.json"), &drive.join("scene.json"))?;
    let out = here.join("out");
    run(program(pcmvs(), "reconstruct").arg(&here).arg("-o").arg(&out))?;
    let mut command = wine(&built().join("pcmvs.exe"))?;
    command.args(["reconstruct", r"c:/Szene ö\scene.json", "-o", r"C:\Szene ö\out"]);
    run(&mut command)?;
    compare(&out.join("frame_0000.glb"), &drive.join("out/frame_0000.glb"))
}

/// Writes a small scene with so many frames, and its cameras as Middlebury's file with `\\` in the names of the first frame's
/// pictures.
fn calibrated(folder: &Path, frames: u32) -> Result<()> {
    let times: Vec<f64> = (0..frames).map(|frame| f64::from(frame) / 30.0).collect();
    let cameras = Ring { count: 10, ..Ring::default() }.sized(160, 120).cameras();
    let capture = Capture::new(Subject::Figure, &cameras, &times, &Faults::default());
    capture.write(folder).map_err(problem(folder))?;
    let mut text = format!("{}\n", cameras.len());
    for (name, camera) in capture.names.iter().zip(&cameras) {
        let numbers = camera.k.as_flattened().iter().chain(camera.r.as_flattened()).chain(&camera.t);
        let numbers: Vec<String> = numbers.map(f64::to_string).collect();
        let _ = writeln!(text, r"images\{name}_0000.png {}", numbers.join(" "));
    }
    let file = folder.join("rig_par.txt");
    fs::write(&file, text).map_err(problem(&file))
}

/// Ctrl-C ends the command line with the status for it, and leaves no half-written file.
fn interrupt() -> Result<()> {
    let files = empty("interrupt")?;
    let (scene, out) = (files.join("scene"), files.join("out"));
    calibrated(&scene, 20)?;
    let exe = files.join("interrupt.exe");
    let mut cc = program(CC, "-municode -O1 -Wall -Wextra -Werror -o");
    run(cc.arg(&exe).arg(root().join("tests/windows/interrupt.c")))?;

    // Wine gives programs a console that knows Ctrl-C only if it has a terminal itself.
    let mut line = String::from("exec wine");
    let first = out.join("frame_0000.glb");
    for path in [&exe, &first, &built().join("pcmvs.exe")] {
        let _ = write!(line, " '{}'", windows_path(path));
    }
    let _ = write!(line, " reconstruct '{}' -o '{}'", windows_path(&scene), windows_path(&out));
    let command = wine(&exe)?;
    let mut terminal = program("script", "--quiet --return --command");
    terminal.arg(line).arg("/dev/null").env("TERM", "xterm");
    command.get_envs().for_each(|(name, value)| _ = terminal.env(name, value.unwrap_or_default()));
    let output = terminal.output().map_err(|e| format!("script cannot be run: {e}"))?;
    let printed = String::from_utf8_lossy(&output.stdout);
    if output.status.code() != Some(3) || !printed.contains("cancelled") {
        return Err(format!("Ctrl-C: {}:\n{printed}", output.status));
    }
    let names: Vec<_> = fs::read_dir(&out).map_err(problem(&out))?.flatten().map(|entry| entry.file_name()).collect();
    match names.iter().find(|name| name.to_string_lossy().ends_with(".tmp")) {
        Some(half) => Err(format!("Ctrl-C leaves {}", half.display())),
        None if names.len() > 20 => Err(String::from("Ctrl-C came after the last frame")),
        None => Ok(()),
    }
}
