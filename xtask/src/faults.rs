//! How the results degrade when inputs are spoilt on purpose: the fault curves of BENCHMARKS.md.

use crate::{
    Result,
    measure::{Captured, python},
    process::{run, target},
    tables::{Table, figure},
};
use serde_json::Value;
use std::fs;

/// The scene whose inputs are spoilt. Only one fault needs a scene with several frames.
const SCENE: &str = "akimbo";
const MOVING_SCENE: &str = "motion";
const MOVING_FAULT: &str = "cam 5 from frame 3";

/// Measures all faults with the default preset. The tool that spoils the inputs, faults.py, lies beside the one that
/// scores.
pub fn table(captured: &Captured) -> Result<String> {
    let out = target().join("captured/faults");
    if out.exists() {
        fs::remove_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
    }
    let mut table = Table::new(&["fault", "acc90 mm", "F@2.5", "lost %", "IoU", "bodies", "CPU s", "MiB", "warnings"]);
    for (scene, only) in [(SCENE, None), (MOVING_SCENE, Some(MOVING_FAULT))] {
        let mut command = python();
        command.arg(captured.tool("faults.py")).arg(captured.pcmvs());
        command.arg(captured.scene(scene)).arg(&out).args(["--presets", "default"]);
        run(command.args(only.into_iter().flat_map(|fault| ["--only", fault])))?;
        let rows = out.join(format!("{scene}.jsonl"));
        let text = fs::read_to_string(&rows).map_err(|e| format!("{}: {e}", rows.display()))?;
        for line in text.lines() {
            let found: Value = serde_json::from_str(line).map_err(|e| format!("{}: {e}", rows.display()))?;
            table.row(&row(&found));
        }
    }
    Ok(table.text())
}

fn row(found: &Value) -> [String; 9] {
    let number = |key: &str, digits| figure(found[key].as_f64(), digits);
    let said = found["said"].as_array().map_or(0, Vec::len);
    [
        found["fault"].as_str().unwrap_or("?").to_owned(),
        number("acc90", 1),
        number("f2.5", 1),
        number("lost10", 1),
        number("iou", 3),
        number("components", 0),
        number("cpu", 1),
        number("mib", 0),
        said.to_string(),
    ]
}
