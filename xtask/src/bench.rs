//! `cargo xtask bench`: measures the tables of BENCHMARKS.md.

use crate::{
    Result, browser, faults, instructions,
    measure::{Captured, Job, Measured},
    process::root,
    speed,
    tables::{Table, figure, replace_in},
    take,
};
use std::fs;

const SCENES: [&str; 8] =
    ["akimbo", "suit", "motion", "akimbo-rough", "suit-rough", "motion-rough", "wd2", "dino-sparse-ring"];
const PRESETS: [&str; 3] = ["hull", "paper", "default"];

/// Scenes with ground truth, each with the frames that the ablations use.
const ABLATION_SCENES: [(&str, &str); 6] = [
    ("akimbo", "0"),
    ("suit", "0"),
    ("motion", "0"),
    ("akimbo-rough", "0"),
    ("suit-rough", "0"),
    ("motion-rough", "0"),
];

/// A step of the paper and the parameters that switch it off.
struct Ablation {
    name: &'static str,
    off: &'static [&'static str],
    /// Whether the default preset uses it, too.
    in_default: bool,
}

const ABLATIONS: [Ablation; 13] = [
    Ablation {
        name: "local-maximum rule (eq. 1)",
        off: &["detection.search.vote.support=\"scores\""],
        in_default: true,
    },
    Ablation {
        name: "Gaussian over the curves (§4.1)",
        off: &["detection.search.vote.smoothing=null"],
        in_default: false,
    },
    Ablation { name: "hull fallback (§4.2)", off: &["detection.substitution=null"], in_default: true },
    Ablation { name: "density constraint (§4.3)", off: &["detection.clean.density=null"], in_default: true },
    Ablation { name: "PCA constraint (§4.3)", off: &["detection.clean.flatness=null"], in_default: true },
    Ablation { name: "normal constraint (§4.3)", off: &["detection.clean.facing=null"], in_default: false },
    Ablation { name: "frontier points (§4.4)", off: &["frontier=null"], in_default: true },
    Ablation { name: "implicit points (§4.4)", off: &["implicit=null"], in_default: false },
    Ablation { name: "downsampling, eq. 2 (§5.1)", off: &["merging.downsample=null"], in_default: false },
    Ablation { name: "conflict cleaning (§5.2)", off: &["merging.conflicts=null"], in_default: false },
    Ablation { name: "virtual views (§5.2)", off: &["merging.conflicts.virtual_views=0"], in_default: false },
    Ablation { name: "weights, eq. 3 (§6.1)", off: &["meshing.weights=null"], in_default: true },
    Ablation { name: "space constraint (§6.2)", off: &["meshing.space_constraint=null"], in_default: true },
];

/// The configurations of §7.3 on a ring of 20.
const CONFIGURATIONS: [(&str, Option<&str>); 3] = [
    ("PCMVS-20", None),
    ("PCMVS-10, every second camera", Some("0,2,4,6,8,10,12,14,16,18")),
    ("PCMVS-BINO, five pairs", Some("0,1,4,5,8,9,12,13,16,17")),
];

/// The tables. Each can be renewed by itself.
const PARTS: [&str; 13] = [
    "scores",
    "ablations-default",
    "faults",
    "configurations",
    "ablations-paper",
    "scaling",
    "threads",
    "schedule",
    "meshing",
    "instructions",
    "wasm",
    "steadiness",
    "long-take",
];

/// A table that does not need the captured scenes.
fn without_captures(name: &str) -> Option<Result<String>> {
    Some(match name {
        "scaling" => speed::scaling(),
        "threads" => speed::threads(),
        "schedule" => speed::schedule(),
        "meshing" => speed::meshing(),
        "instructions" => instructions::table(),
        "wasm" => browser::table(),
        "steadiness" => take::steadiness(),
        "long-take" => take::memory(),
        _ => return None,
    })
}

/// Measures and writes all tables or one. With `quick`, it uses one scene, one frame and two ablations, and prints the
/// tables.
pub fn run(quick: bool, part: Option<&str>) -> Result<()> {
    if let Some(part) = part.filter(|part| !PARTS.contains(part)) {
        return Err(format!("there is no table {part}: name one of {}", PARTS.join(", ")));
    }
    let write = |made: &[(&str, String)]| replace_in(&root().join("BENCHMARKS.md"), made);
    if let Some((part, made)) = part.and_then(|part| Some((part, without_captures(part)?))) {
        return write(&[(part, made?)]);
    }
    let captured = Captured::find()??;
    let chosen = if quick { &ABLATIONS[..2] } else { &ABLATIONS };
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
            "faults" => vec![(name, faults::table(&captured)?)],
            "configurations" => vec![(name, configurations(&captured)?)],
            _ => match without_captures(name) {
                Some(table) => vec![(name, table?)],
                None => vec![(name, ablations(&captured, &name["ablations-".len()..], chosen, ablation_scenes)?)],
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

/// Measures every scene with every preset.
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

/// Processor, system and compiler in one line.
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

/// The table of README: the result next to that of the visual hull.
fn summary(results: &[(&str, &str, Measured)]) -> String {
    let mut table = Table::new(&["", "acc90 mm", "F@2.5", "F@5", "normals °", "silhouette IoU", "s per frame", "MiB"]);
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

/// How much worse a scene becomes without a step: percentage points of F@2.5 and F@5, millimetres of acc90.
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

    /// Whether the change is larger than the last digit of the table.
    fn is_significant(&self) -> bool {
        self.f25 >= 0.1 || self.f5 >= 0.1 || self.acc90 >= 0.05
    }
}

fn ablations(captured: &Captured, preset: &str, chosen: &[Ablation], scenes: &[(&str, &str)]) -> Result<String> {
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
    for ablation in chosen.iter().filter(|ablation| preset == "paper" || ablation.in_default) {
        let mut set: Vec<String> = ablation.off.iter().map(|&s| s.to_owned()).collect();
        if preset == "default" {
            // The coarse pass has detection parameters, too.
            let coarse = ablation.off.iter().filter(|s| s.starts_with("detection.")).map(|s| format!("coarse.{s}"));
            set.extend(coarse);
        }
        let without = measure(&set)?;
        let losses = whole.iter().zip(&without).map(|(a, b)| Loss::new(a, b));
        let helps: Vec<&str> = losses.zip(scenes).filter(|(loss, _)| loss.is_significant()).map(|(_, s)| s.0).collect();
        if helps.is_empty() {
            useless.push(ablation.name);
        }
        table.row(&row(ablation.name, &without, &helps.join(", ")));
    }
    let remark = if useless.is_empty() {
        String::from("Every step helps on at least one scene.")
    } else {
        format!("These steps help on none of the scenes: {}.", useless.join("; "))
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
