//! Tables of BENCHMARKS.md about takes of the studio's figure: how steady they are, and that memory does not grow.

use crate::{
    Result,
    measure::{build, reported_frames},
    process::{cargo, program, run, target},
    tables::{Table, figure},
};
use std::{fs, time::Instant};

/// Frames after which memory is read.
const FRAMES: [u64; 3] = [20, 100, 300];

/// How steady a take is, frame by frame and averaged.
pub fn steadiness() -> Result<String> {
    Ok(run(&mut cargo("run --quiet --release -p facts --example steadiness"))?.trim_end().to_owned())
}

/// Largest memory of the process after some frames of a long take, for one and two threads, and the time of the take.
pub fn memory() -> Result<String> {
    build()?;
    let folder = target().join("long-take");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let last = FRAMES[FRAMES.len() - 1];
    let scene = folder.join("scene");
    let studio = format!("--size 320x240 --views 12 --frames {last} --output");
    run(program(target().join("release/studio"), &studio).arg(&scene))?;
    let mut header = vec![String::from("threads")];
    header.extend(FRAMES.iter().map(|frame| format!("MiB after frame {frame}")));
    header.extend([String::from("s"), String::from("times one thread")]);
    let mut table = Table::new(&header);
    let mut first = None;
    for threads in [1, 2] {
        let out = folder.join(threads.to_string());
        let start = Instant::now();
        let mut command = program(target().join("release/pcmvs"), &format!("reconstruct --threads {threads}"));
        run(command.arg(&scene).arg("-o").arg(&out))?;
        let seconds = start.elapsed().as_secs_f64();
        let frames = reported_frames(&out)?;
        let memory = |frame: u64| {
            let found = frames.iter().find(|f| f["index"] == frame - 1);
            found.and_then(|f| f["peak_memory"].as_f64()).map(|bytes| bytes / f64::from(1 << 20))
        };
        let mut row = vec![threads.to_string()];
        row.extend(FRAMES.iter().map(|&frame| figure(memory(frame), 1)));
        row.push(figure(Some(seconds), 0));
        row.push(figure(Some(*first.get_or_insert(seconds) / seconds), 2));
        table.row(&row);
    }
    Ok(table.text())
}
