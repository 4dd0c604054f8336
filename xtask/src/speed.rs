//! Measures how time grows with views and pixels, the gain of a second thread, and meshing against another solver.

use crate::{
    Result, instructions,
    measure::{Measured, build, install_packages, python, reported_frames},
    process::{cargo, program, run, target},
    tables::{Table, figure},
};
use golden::case::LARGE;
use std::{
    fs,
    path::{Path, PathBuf},
    time::Instant,
};

/// One run of the command.
struct Run {
    /// Seconds from start to end.
    wall: f64,
    measured: Measured,
}

impl Run {
    /// Mean seconds per frame of the steps that `wanted` names.
    fn seconds(&self, wanted: impl Fn(&str) -> bool) -> f64 {
        self.measured.seconds().iter().filter(|(name, _)| wanted(name)).map(|(_, s)| s).sum()
    }
}

fn folder() -> PathBuf {
    target().join("speed")
}

/// Renders a capture of the studio's figure, unless it exists.
fn capture(views: u32, (width, height): (u32, u32), frames: u32) -> Result<PathBuf> {
    let scene = folder().join(format!("{views}x{width}x{frames}"));
    if !scene.join("scene.json").exists() {
        eprintln!("rendering {views} views of {width} x {height}");
        let arguments = format!("--size {width}x{height} --views {views} --frames {frames} --output");
        run(program(target().join("release/studio"), &arguments).arg(&scene))?;
    }
    Ok(scene)
}

fn reconstruct(scene: &Path, threads: u32) -> Result<Run> {
    let out = folder().join("out");
    if out.exists() {
        fs::remove_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
    }
    let mut command = program(target().join("release/pcmvs"), &format!("reconstruct --threads {threads}"));
    let start = Instant::now();
    run(command.arg(scene).arg("-o").arg(&out))?;
    let wall = start.elapsed().as_secs_f64();
    Ok(Run { wall, measured: Measured { scores: Vec::new(), frames: reported_frames(&out)? } })
}

/// The faster of two runs.
fn best(scene: &Path, threads: u32) -> Result<Run> {
    let (a, b) = (reconstruct(scene, threads)?, reconstruct(scene, threads)?);
    Ok(if a.wall < b.wall { a } else { b })
}

/// Seconds and memory for more views, and for larger pictures.
pub fn scaling() -> Result<String> {
    build()?;
    let sizes = [(320, 240), (640, 480), (1024, 768), (2048, 1536)];
    let views = [5, 10, 20, 40].map(|views| (views, (1024, 768)));
    let widths = sizes.map(|size| (20, size));
    let mut table = Table::new(&["views", "pictures", "s", "s per view and megapixel", "MiB"]);
    for (views, (width, height)) in views.into_iter().chain(widths) {
        let run = best(&capture(views, (width, height), 1)?, 1)?;
        // From files to the coloured mesh.
        let seconds = run.seconds(|name| name != "write");
        let megapixels = f64::from(views * width * height) / 1e6;
        table.row(&[
            views.to_string(),
            format!("{width} x {height}"),
            figure(Some(seconds), 2),
            figure(Some(seconds / megapixels), 3),
            figure(Some(run.measured.peak_mebibytes()), 0),
        ]);
    }
    Ok(table.text())
}

/// The gain of two threads over one, for one frame and for many.
pub fn threads() -> Result<String> {
    build()?;
    let mut table = Table::new(&["two threads instead of one", "1: s", "2: s", "times"]);
    let mut row = |name: &str, one: f64, two: f64| {
        table.row(&[name.to_owned(), figure(Some(one), 2), figure(Some(two), 2), figure(Some(one / two), 2)]);
    };
    let one_frame = capture(20, (1024, 768), 1)?;
    let (one, two) = (best(&one_frame, 1)?, best(&one_frame, 2)?);
    let detect = |name: &str| name == "detect";
    row("one frame: detection", one.seconds(detect), two.seconds(detect));
    row("one frame: all of it", one.wall, two.wall);
    let clip = capture(20, (1024, 768), 8)?;
    row("eight frames", best(&clip, 1)?.wall, best(&clip, 2)?.wall);
    Ok(table.text())
}

/// What any number of threads can gain: the share of the work that they cannot share, and a simulation with measured jobs.
pub fn schedule() -> Result<String> {
    run(&mut cargo("build --quiet --release --package speed"))?;
    let capture = instructions::capture(&LARGE)?;
    let simulated = || -> Result<Vec<(u32, f64)>> {
        let printed = run(program(target().join("release/speed"), "").arg(&capture).arg("schedule"))?;
        let row = |line: &str| line.split_once(' ').and_then(|(n, s)| Some((n.parse().ok()?, s.parse().ok()?)));
        printed.lines().map(|line| row(line).ok_or_else(|| format!("speed: `{line}` is not a row"))).collect()
    };
    // The faster of two runs.
    let (a, b) = (simulated()?, simulated()?);
    let times = if a[0].1 < b[0].1 { a } else { b };
    let mut table = Table::new(&["threads", "s", "times"]);
    for (threads, seconds) in &times {
        let gain = times[0].1 / seconds;
        table.row(&[threads.to_string(), figure(Some(*seconds), 2), figure(Some(gain), 2)]);
    }
    let serial = 100.0 * instructions::serial_share()?;
    Ok(format!("{}\n\n{serial:.1} % of a frame's instructions are outside of jobs.", table.text()))
}

/// Meshes the same points with Open3D, which uses Kazhdan's PoissonRecon. Seconds of processor time on one thread.
const OTHER: &str = "
import sys, time, numpy as np, open3d as o3d
for name in ['exact', 'noisy']:
    cloud = o3d.io.read_point_cloud(f'{sys.argv[1]}/torus-{name}.ply')
    seconds = np.inf
    for _ in range(3):
        start = time.process_time()
        mesh, _ = o3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=8, n_threads=1)
        seconds = min(seconds, time.process_time() - start)
    p = np.asarray(mesh.vertices)
    ring = np.hypot(p[:, 0], p[:, 1]) - 0.38
    error = np.abs(0.15 - np.hypot(ring, p[:, 2]))
    print(name, seconds, len(p), error.mean() * 1e3, np.quantile(error, 0.99) * 1e3)
";

/// Meshing of 200,000 points on a torus, exact and noisy, compared with Open3D.
pub fn meshing() -> Result<String> {
    fs::create_dir_all(folder()).map_err(|e| format!("{}: {e}", folder().display()))?;
    install_packages()?;
    let ours = run(cargo("run --quiet --release --package pcmvs-core --example meshing").arg(folder()))?;
    let other = run(python().args(["-c", OTHER]).arg(folder()))?;
    let mut table =
        Table::new(&["200,000 points on a torus", "s", "vertices", "mean error, ‰", "99 % within, ‰", "times faster"]);
    for (ours, other) in ours.lines().zip(other.lines()) {
        let (cloud, ours) = meshed(ours)?;
        let (_, other) = meshed(other)?;
        for (solver, f) in [("pcmvs", ours), ("Open3D (PoissonRecon), depth 8, one thread", other)] {
            let [seconds, vertices, mean, most] = f;
            table.row(&[
                format!("{cloud}, {solver}"),
                figure(Some(seconds), 2),
                figure(Some(vertices), 0),
                figure(Some(mean), 3),
                figure(Some(most), 3),
                figure(Some(other[0] / seconds), 1),
            ]);
        }
    }
    Ok(table.text())
}

/// Parses a solver's line: name of the cloud, seconds, vertices, mean error and 99 % quantile of the error.
fn meshed(line: &str) -> Result<(&str, [f64; 4])> {
    let unexpected = || format!("unexpected output: {line}");
    let (cloud, figures) = line.split_once(' ').ok_or_else(unexpected)?;
    let figures: Vec<f64> = figures.split(' ').filter_map(|v| v.parse().ok()).collect();
    Ok((cloud, figures.try_into().map_err(|_| unexpected())?))
}
