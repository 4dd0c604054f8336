//! `cargo xtask bench`: the tables of BENCHMARKS.md.

use crate::{
    Result, browser, instructions,
    measure::{Captured, Job, Measured},
    process::root,
    speed,
    tables::{Table, figure, replace_in},
};
use std::fs;

const SCENES: [&str; 5] = ["akimbo", "suit", "motion", "wd2", "dino-sparse-ring"];
const PRESETS: [&str; 3] = ["hull", "paper", "default"];

/// Scenes with ground truth, and the frames that ablations use of them.
const ABLATION_SCENES: [(&str, &str); 3] = [("akimbo", "0"), ("suit", "0"), ("motion", "0")];

/// An idea of the paper and the parameters that switch it off.
struct Idea {
    name: &'static str,
    off: &'static [&'static str],
    /// Whether the default preset has it too.
    in_default: bool,
}

const IDEAS: [Idea; 13] = [
    Idea { name: "local-maximum rule (eq. 1)", off: &["detection.search.vote.local_maximum=false"], in_default: true },
    Idea { name: "Gaussian over the curves (§4.1)", off: &["detection.search.vote.smoothing=0"], in_default: false },
    Idea { name: "hull fallback (§4.2)", off: &["detection.substitute=false"], in_default: true },
    Idea { name: "density constraint (§4.3)", off: &["detection.clean.density=0"], in_default: true },
    Idea { name: "PCA constraint (§4.3)", off: &["detection.clean.flatness=1"], in_default: true },
    Idea { name: "normal constraint (§4.3)", off: &["detection.clean.facing=0"], in_default: true },
    Idea { name: "frontier points (§4.4)", off: &["frontier=null"], in_default: true },
    Idea { name: "implicit points (§4.4)", off: &["implicit=false"], in_default: true },
    Idea { name: "downsampling, eq. 2 (§5.1)", off: &["merging.downsample=null"], in_default: false },
    Idea { name: "conflict cleaning (§5.2)", off: &["merging.conflicts=null"], in_default: false },
    Idea { name: "virtual views (§5.2)", off: &["merging.conflicts.virtual_views=0"], in_default: false },
    Idea { name: "weights, eq. 3 (§6.1)", off: &["merging.fidelity_weights=false"], in_default: true },
    Idea { name: "space constraint (§6.2)", off: &["meshing.space_constraint=false"], in_default: true },
];

/// The configurations of §7.3 on a ring of 20.
const CONFIGURATIONS: [(&str, Option<&str>); 3] = [
    ("PCMVS-20", None),
    ("PCMVS-10, every second camera", Some("0,2,4,6,8,10,12,14,16,18")),
    ("PCMVS-BINO, five pairs", Some("0,1,4,5,8,9,12,13,16,17")),
];

/// The tables, each of which can be renewed alone.
const PARTS: [&str; 9] = [
    "scores",
    "ablations-default",
    "configurations",
    "ablations-paper",
    "scaling",
    "threads",
    "meshing",
    "instructions",
    "wasm",
];

/// A table that needs no captured scenes.
fn without_captures(name: &str) -> Option<Result<String>> {
    Some(match name {
        "scaling" => speed::scaling(),
        "threads" => speed::threads(),
        "meshing" => speed::meshing(),
        "instructions" => instructions::table(),
        "wasm" => browser::table(),
        _ => return None,
    })
}

/// Measures and writes the tables, all or one; `quick` takes one scene, one frame and two ideas, and prints them.
pub fn run(quick: bool, part: Option<&str>) -> Result<()> {
    if let Some(part) = part.filter(|part| !PARTS.contains(part)) {
        return Err(format!("there is no table {part}: {}", PARTS.join(", ")));
    }
    let write = |made: &[(&str, String)]| replace_in(&root().join("BENCHMARKS.md"), made);
    if let Some((part, made)) = part.and_then(|part| Some((part, without_captures(part)?))) {
        return write(&[(part, made?)]);
    }
    let captured = Captured::find()??;
    let ideas = if quick { &IDEAS[..2] } else { &IDEAS };
    let ablation_scenes = if quick { &ABLATION_SCENES[..1] } else { &ABLATION_SCENES };
    let parts = if quick { &PARTS[..2] } else { &PARTS[..] };
    for name in parts.iter().copied().filter(|name| part.is_none_or(|part| part == *name)) {
        let made = match name {
            "scores" => {
                let results = results(&captured, if quick { &SCENES[..1] } else { &SCENES })?;
                if !quick {
                    replace_in(&root().join("README.md"), &[("summary", summary(&results))])?;
                }
                vec![("machine", machine()), ("scores", scores(&results)), ("seconds", seconds(&results))]
            }
            "configurations" => vec![(name, configurations(&captured)?)],
            _ => match without_captures(name) {
                Some(table) => vec![(name, table?)],
                None => vec![(name, ablations(&captured, &name["ablations-".len()..], ideas, ablation_scenes)?)],
            },
        };
        if quick {
            made.iter().for_each(|(name, table)| println!("## {name}\n\n{table}\n"));
        } else {
            write(&made)?;
        }
    }
    Ok(())
}

/// Every scene by every preset.
fn results(captured: &Captured, scenes: &[&'static str]) -> Result<Vec<(&'static str, &'static str, Measured)>> {
    let mut results = Vec::new();
    for scene in scenes {
        for preset in PRESETS {
            eprintln!("{scene}, {preset}");
            results.push((*scene, preset, captured.measure(&Job::new(scene, preset))?));
        }
    }
    Ok(results)
}

/// Processor, system and compiler in a line.
fn machine() -> String {
    let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let model = model.map_or("unknown processor", |(_, name)| name);
    let compiler = crate::process::run(&mut crate::process::program("rustc", "--version")).unwrap_or_default();
    let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
    format!("{model}, one thread, {os} {arch}, {}, pcmvs {}.", compiler.trim(), env!("CARGO_PKG_VERSION"))
}

fn yes(measured: &Measured) -> String {
    let all = |key: &str| measured.scores.iter().all(|s| s[key] == true);
    String::from(if all("closed") && all("manifold") && all("finite") { "yes" } else { "no" })
}

fn scores(results: &[(&str, &str, Measured)]) -> String {
    let mut table = Table::new(&[
        "scene, preset",
        "acc90 mm",
        "F@2.5",
        "F@5",
        "seen @5",
        "normals °",
        "IoU",
        "worst",
        "PSNR dB",
        "closed, manifold",
        "parts",
        "s",
        "MiB",
    ]);
    for (scene, preset, m) in results {
        let parts = m.scores.iter().filter_map(|s| s["components"].as_u64()).max();
        table.row(&[
            format!("{scene}, {preset}"),
            figure(m.mean("acc90_mm"), 2),
            figure(m.mean("f_pct@2.5"), 1),
            figure(m.mean("f_pct@5"), 1),
            figure(m.mean("comp_seen_pct@5"), 1),
            figure(m.mean("normal_deg"), 1),
            figure(m.mean("sil_iou_mean"), 4),
            figure(m.mean("sil_iou_min"), 3),
            figure(m.mean("psnr_db"), 1),
            yes(m),
            parts.map_or_else(String::new, |n| n.to_string()),
            figure(Some(m.total_seconds()), 1),
            figure(Some(m.peak_mebibytes()), 0),
        ]);
    }
    table.text()
}

/// The README's table: the result beside what it must beat.
fn summary(results: &[(&str, &str, Measured)]) -> String {
    let mut table = Table::new(&["", "acc90 mm", "F@2.5", "F@5", "normals °", "silhouette IoU", "s a frame", "MiB"]);
    for (scene, preset, m) in results.iter().filter(|(_, preset, m)| *preset != "paper" && m.mean("acc90_mm").is_some())
    {
        table.row(&[
            format!("{scene}, {}", if *preset == "hull" { "visual hull" } else { "pcmvs" }),
            figure(m.mean("acc90_mm"), 1),
            figure(m.mean("f_pct@2.5"), 1),
            figure(m.mean("f_pct@5"), 1),
            figure(m.mean("normal_deg"), 1),
            figure(m.mean("sil_iou_mean"), 3),
            figure(Some(m.total_seconds()), 1),
            figure(Some(m.peak_mebibytes()), 0),
        ]);
    }
    table.text()
}

fn seconds(results: &[(&str, &str, Measured)]) -> String {
    let mut names: Vec<String> = Vec::new();
    for (name, _) in results.iter().flat_map(|(_, _, m)| m.seconds()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut table = Table::new(&[&[String::from("scene, preset")], names.as_slice()].concat());
    for (scene, preset, m) in results {
        let seconds = m.seconds();
        let of = |name: &String| figure(seconds.iter().find(|(n, _)| n == name).map(|(_, s)| *s), 2);
        table.row(&[&[format!("{scene}, {preset}")], names.iter().map(of).collect::<Vec<_>>().as_slice()].concat());
    }
    table.text()
}

/// What a scene loses without an idea, in points of F@2.5 and F@5 and millimetres of acc90.
struct Loss {
    f25: f64,
    f5: f64,
    acc90: f64,
}

impl Loss {
    fn new(with: &Measured, without: &Measured) -> Self {
        let change = |key: &str| with.mean(key).zip(without.mean(key)).map_or(f64::NAN, |(a, b)| b - a);
        Self { f25: -change("f_pct@2.5"), f5: -change("f_pct@5"), acc90: change("acc90_mm") }
    }

    /// More than the last digit of the table.
    fn is_felt(&self) -> bool {
        self.f25 >= 0.1 || self.f5 >= 0.1 || self.acc90 >= 0.05
    }
}

fn ablations(captured: &Captured, preset: &str, ideas: &[Idea], scenes: &[(&str, &str)]) -> Result<String> {
    let mut header = vec![String::from("without")];
    for (scene, _) in scenes {
        header.extend(["acc90", "F@2.5", "F@5"].map(|figure| format!("{scene} {figure}")));
    }
    header.push(String::from("helps on"));
    let mut table = Table::new(&header);
    let mut useless = Vec::new();
    let row = |name: &str, measured: &[Measured], helps: &str| {
        let figures = measured.iter().flat_map(|m| {
            [figure(m.mean("acc90_mm"), 2), figure(m.mean("f_pct@2.5"), 1), figure(m.mean("f_pct@5"), 1)]
        });
        [name.to_owned()].into_iter().chain(figures).chain([helps.to_owned()]).collect::<Vec<_>>()
    };
    let measure = |set: &[String]| -> Result<Vec<Measured>> {
        let job = |&(scene, frames): &(&str, &str)| {
            eprintln!("{scene}, {preset} {}", set.join(" "));
            captured.measure(&Job { frames: Some(frames), set, ..Job::new(scene, preset) })
        };
        scenes.iter().map(job).collect()
    };
    let whole = measure(&[])?;
    table.row(&row("(nothing)", &whole, ""));
    for idea in ideas.iter().filter(|idea| preset == "paper" || idea.in_default) {
        let mut set: Vec<String> = idea.off.iter().map(|&s| s.to_owned()).collect();
        if preset == "default" {
            // Its coarse pass detects as well.
            let coarse = idea.off.iter().filter(|s| s.starts_with("detection.")).map(|s| format!("coarse.{s}"));
            set.extend(coarse);
        }
        let without = measure(&set)?;
        let losses = whole.iter().zip(&without).map(|(a, b)| Loss::new(a, b));
        let helps: Vec<&str> = losses.zip(scenes).filter(|(loss, _)| loss.is_felt()).map(|(_, s)| s.0).collect();
        if helps.is_empty() {
            useless.push(idea.name);
        }
        table.row(&row(idea.name, &without, &helps.join(", ")));
    }
    let remark = if useless.is_empty() {
        String::from("Every idea helps on at least one scene.")
    } else {
        format!("On none of these scenes does this help: {}.", useless.join("; "))
    };
    Ok(format!("{}\n\n{remark}", table.text()))
}

fn configurations(captured: &Captured) -> Result<String> {
    let mut table = Table::new(&["akimbo, default", "acc90 mm", "F@2.5", "F@5", "seen @5", "normals °", "IoU", "s"]);
    for (name, cameras) in CONFIGURATIONS {
        let m = captured.measure(&Job { cameras, ..Job::new("akimbo", "default") })?;
        table.row(&[
            name.to_owned(),
            figure(m.mean("acc90_mm"), 2),
            figure(m.mean("f_pct@2.5"), 1),
            figure(m.mean("f_pct@5"), 1),
            figure(m.mean("comp_seen_pct@5"), 1),
            figure(m.mean("normal_deg"), 1),
            figure(m.mean("sil_iou_mean"), 4),
            figure(Some(m.total_seconds()), 1),
        ]);
    }
    Ok(table.text())
}
