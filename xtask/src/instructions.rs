//! Counts the instructions of each stage. Unlike times, the counts have no noise, so that a slower stage is visible.

use crate::{
    Result,
    process::{cargo, program, root, run, target},
    setup::{self, Package},
    tables::{Table, content, figure},
};
use golden::case::{Case, LARGE};
use std::{fs, path::PathBuf};

/// Small enough for callgrind, which interprets the program.
const CAPTURE: Case = Case { name: "medium", preset: "default", views: 20, size: (320, 240) };
/// Relative increase over the committed table that gives a warning.
const TOLERANCE: f64 = 0.1;
const VALGRIND: Package = ("valgrind", "/usr/bin/valgrind");
/// Name of the table in BENCHMARKS.md.
const NAME: &str = "instructions";
const FILE: &str = "BENCHMARKS.md";

/// Counts, compares with the committed table, and prints the changes.
pub fn table() -> Result<String> {
    setup::debian(&[VALGRIND])?;
    let counts = count(&CAPTURE, false)?;
    match committed() {
        Ok(before) => compare(&before, &counts),
        Err(why) => eprintln!("warning: there is no committed table to compare with: {why}"),
    }
    let mut table = Table::new(&[String::from("stage"), format!("million instructions, {}", conditions()?)]);
    counts.iter().for_each(|(stage, millions)| table.row(&[stage.clone(), figure(Some(*millions), 3)]));
    Ok(table.text())
}

/// What the counts depend on besides the source.
fn conditions() -> Result<String> {
    let compiler = run(&mut program("rustc", "--version"))?;
    let version = compiler.split(' ').nth(1).unwrap_or("unknown");
    let (views, (width, height)) = (CAPTURE.views, CAPTURE.size);
    Ok(format!("{views} views of {width} x {height}, {}, rustc {version}", std::env::consts::ARCH))
}

/// Renders a capture for `tests/speed` and returns its path.
pub fn capture(case: &Case) -> Result<PathBuf> {
    let folder = target().join("speed");
    let path = folder.join(format!("{}.capture", case.name));
    let fail = |e| format!("{}: {e}", path.display());
    fs::create_dir_all(&folder).map_err(fail)?;
    fs::write(&path, case.render().to_bytes()).map_err(fail)?;
    Ok(path)
}

/// Share of a frame's instructions that no number of threads makes faster: those outside of the jobs of the host's executor.
pub fn serial_share() -> Result<f64> {
    setup::debian(&[VALGRIND])?;
    let all = |in_jobs: bool| -> Result<f64> {
        let counts = count(&LARGE, in_jobs)?;
        Ok(counts.iter().filter(|(stage, _)| stage != "glb" && stage != "all").map(|(_, millions)| millions).sum())
    };
    Ok(1.0 - all(true)? / all(false)?)
}

/// Millions of instructions of each stage, between the stages, and in total; those of jobs only if `in_jobs`.
fn count(case: &Case, in_jobs: bool) -> Result<Vec<(String, f64)>> {
    run(&mut cargo("build --quiet --release --package speed"))?;
    let capture = capture(case)?;
    let folder = target().join("speed/callgrind");
    let fail = |e| format!("{}: {e}", folder.display());
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(fail)?;
    }
    fs::create_dir_all(&folder).map_err(fail)?;
    let mut valgrind = program("valgrind", "--quiet --tool=callgrind --dump-before=speed::boundary");
    if in_jobs {
        valgrind.arg("--toggle-collect=speed::jobs::all*");
    }
    valgrind.arg(format!("--callgrind-out-file={}", folder.join("out").display()));
    let printed = run(valgrind.arg(target().join("release/speed")).arg(capture).arg("1"))?;
    // The last two lines are the frame and the hash.
    let lines: Vec<&str> = printed.lines().collect();
    let stages = lines[..lines.len().saturating_sub(2)].iter().filter_map(|line| line.split(' ').next());

    // Every boundary resets the counters. Dump 1 is before the first stage, dump 2 the first stage, dump 3 between the
    // first and the second, dump 4 the second stage, and so on.
    let mut counts = Vec::new();
    let mut between = 0.0;
    for (i, stage) in stages.enumerate() {
        if i > 0 {
            between += millions(&folder.join(format!("out.{}", 2 * i + 1)))?;
        }
        counts.push((stage.to_owned(), millions(&folder.join(format!("out.{}", 2 * i + 2)))?));
    }
    counts.push((String::from("between them"), between));
    counts.push((String::from("all"), counts.iter().map(|(_, millions)| millions).sum()));
    Ok(counts)
}

/// Millions of instructions in a dump of callgrind.
fn millions(dump: &PathBuf) -> Result<f64> {
    let text = fs::read_to_string(dump).map_err(|e| format!("{}: {e}", dump.display()))?;
    let total = text.lines().find_map(|line| line.strip_prefix("totals: ")?.trim().parse::<f64>().ok());
    total
        .map(|count| count / 1e6)
        .ok_or_else(|| format!("{}: there are no totals: check the version of valgrind", dump.display()))
}

/// The table in the last commit.
fn committed() -> Result<Vec<(String, f64)>> {
    let text = run(program("git", "show").arg(format!("HEAD:{FILE}")).current_dir(root()))?;
    let rows = content(&text, NAME)?.lines().skip(2);
    let row = |line: &str| {
        let mut cells = line.trim_matches(['|', ' ']).split(" | ");
        let (stage, millions) = (cells.next()?.to_owned(), cells.next()?.parse().ok()?);
        Some((stage, millions))
    };
    rows.map(|line| row(line).ok_or_else(|| format!("{FILE}: `{line}` is not a row of {NAME}"))).collect()
}

/// Prints the change of each stage, and warns about those that have become slower.
fn compare(before: &[(String, f64)], now: &[(String, f64)]) {
    for (stage, millions) in now {
        let Some((_, old)) = before.iter().find(|(name, _)| name == stage) else {
            eprintln!("{stage:14} {millions:10.3} million instructions, not in the committed table");
            continue;
        };
        let change = millions / old - 1.0;
        eprintln!("{stage:14} {millions:10.3} million instructions, {:+.3} %", 100.0 * change);
        if change > TOLERANCE {
            eprintln!("warning: {stage} takes {:.1} % more instructions than in the committed table", 100.0 * change);
        }
    }
}
