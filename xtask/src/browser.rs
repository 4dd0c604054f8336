//! The same frame in a browser and in a native program: the cost of WebAssembly.

use crate::{
    Result,
    instructions::capture,
    process::{cargo, program, root, run, target},
    setup,
    tables::{Table, figure},
    web,
};
use golden::case::LARGE;
use serde_json::Value;
use std::path::Path;

/// Rounds per build and run. A browser compiles during the first.
const ROUNDS: &str = "2";
/// Runs of each build, alternating, because a machine may be slow for a while. The fastest round counts.
const RUNS: usize = 2;

/// The times of one build.
struct Timed {
    name: &'static str,
    /// Seconds of each round.
    seconds: Vec<f64>,
    /// The mesh's hash.
    hash: String,
}

impl Timed {
    fn best(&self) -> f64 {
        self.seconds.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

/// 20 views of 1024 x 768, decoded, to the coloured mesh: natively with and without AVX2, and in Chromium.
pub fn table() -> Result<String> {
    web::wasm()?;
    setup::node_packages(&root().join("tests/web"))?;
    run(&mut cargo("build --quiet --release --package speed"))?;
    let baseline = target().join("speed/baseline");
    let mut build = cargo("build --quiet --release --package speed --target-dir");
    run(build.arg(&baseline).env("CARGO_ENCODED_RUSTFLAGS", "--cfg=pcmvs_baseline"))?;

    let capture = capture(&LARGE)?;
    let run_all = || -> Result<Vec<Timed>> {
        let mut builds = vec![
            native("x86-64, AVX2 where there is any", &target().join("release/speed"), &capture)?,
            native("x86-64, baseline", &baseline.join("release/speed"), &capture)?,
        ];
        builds.extend(chromium(&capture)?);
        Ok(builds)
    };
    let mut builds = run_all()?;
    for _ in 1..RUNS {
        for (build, again) in builds.iter_mut().zip(run_all()?) {
            build.seconds.extend(again.seconds);
        }
    }
    let (dispatched, baseline) = (builds[0].best(), builds[1].best());
    let mut table = Table::new(&["one thread", "s", "first frame, s", "times baseline", "times AVX2"]);
    for build in &builds {
        if build.hash != builds[0].hash {
            return Err(format!("{}: mesh {}, not {}", build.name, build.hash, builds[0].hash));
        }
        table.row(&[
            build.name.to_owned(),
            figure(Some(build.best()), 2),
            figure(build.seconds.first().copied(), 2),
            figure(Some(build.best() / baseline), 2),
            figure(Some(build.best() / dispatched), 2),
        ]);
    }
    Ok(table.text())
}

/// Runs `tests/speed`.
fn native(name: &'static str, speed: &Path, capture: &Path) -> Result<Timed> {
    let printed = run(program(speed, "").arg(capture).arg(ROUNDS))?;
    let line = |key: &str| printed.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(' '));
    let (Some(seconds), Some(hash)) = (line("frame"), line("hash")) else {
        return Err(format!("{name}: unexpected output:\n{printed}"));
    };
    let seconds = seconds.split(' ').filter_map(|s| s.parse().ok()).collect();
    Ok(Timed { name, seconds, hash: hash.to_owned() })
}

/// Runs both builds of the npm package.
fn chromium(capture: &Path) -> Result<Vec<Timed>> {
    let printed = run(program("node", "tests/speed/browser.mjs").arg(capture).arg(ROUNDS))?;
    let names = ["WebAssembly in Chromium, simd128", "WebAssembly in Chromium, scalar"];
    let timed = |(name, line): (&'static str, &str)| {
        let made: Value = serde_json::from_str(line).map_err(|e| format!("{line}: {e}"))?;
        let seconds = made["seconds"].as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
        Ok(Timed { name, seconds, hash: made["hash"].as_str().unwrap_or_default().to_owned() })
    };
    names.into_iter().zip(printed.lines()).map(timed).collect()
}
