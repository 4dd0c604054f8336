//! `cargo xtask cycles`: no crate of the workspace has an import cycle between its modules.
//!
//! Our own code, because cargo-modules links rust-analyzer and takes minutes to compile.
//!
//! A module depends on another if one of its paths, in `use` or in code, leads to an item of the other. Re-exports are
//! followed to the module that defines the item. A `mod` declaration is not a dependency, and neither is the re-export
//! of a descendant's item. Tests, attributes and comments do not count. A method call names no module, so it is not
//! seen.
//!
//! Cycles are looked for at each level of the module tree: between a module's own file and its children, each child
//! standing for all modules below it. Therefore two folders must not use each other even if their files form no cycle.

mod component;
mod dependency;
mod krate;
mod module;
mod resolve;

use crate::{
    Result,
    process::{cargo, root, run},
};
use component::components;
use dependency::{Dependency, dependencies, name};
use krate::Crate;
use module::Path;
use std::{collections::BTreeMap, fs, path};

/// Modules that depend on each other, and all dependencies between them.
struct Cycle {
    nodes: Vec<String>,
    dependencies: Vec<String>,
}

/// Checks the whole workspace; returns how many modules it has.
pub fn check() -> Result<String> {
    let read = |file: &path::Path| fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()));
    let (mut modules, mut problems) = (0, Vec::new());
    for (name, file) in targets()? {
        let file = path::Path::new(&file);
        let found = Crate::parse(file.strip_prefix(root()).unwrap_or(file), &|file| read(&root().join(file)))?;
        modules += found.modules.len();
        problems.extend(cycles(&found).iter().map(|cycle| cycle.describe(&name)));
    }
    match problems.len() {
        0 => Ok(format!("{modules} modules")),
        count => Err(format!("{}\n{count} cycles", problems.join("\n"))),
    }
}

/// Names and root files of all libraries and programs of the workspace.
fn targets() -> Result<Vec<(String, String)>> {
    let metadata = run(&mut cargo("metadata --no-deps --format-version 1"))?;
    let metadata: serde_json::Value = serde_json::from_str(&metadata).map_err(|e| format!("cargo metadata: {e}"))?;
    let list = |value: &serde_json::Value| value.as_array().cloned().unwrap_or_default();
    let mut found = Vec::new();
    for package in list(&metadata["packages"]) {
        for target in list(&package["targets"]) {
            let text = |key: &str| target[key].as_str().unwrap_or_default().to_owned();
            let kinds = ["lib", "cdylib", "staticlib", "bin"];
            if list(&target["kind"]).iter().any(|kind| kinds.iter().any(|known| kind == known)) {
                found.push((
                    format!("{} ({})", package["name"].as_str().unwrap_or_default(), text("name")),
                    text("src_path"),
                ));
            }
        }
    }
    Ok(found)
}

/// All cycles of a crate.
fn cycles(of: &Crate) -> Vec<Cycle> {
    let mut levels: BTreeMap<Path, Vec<Dependency>> = BTreeMap::new();
    for dependency in dependencies(of) {
        levels.entry(common(&dependency.from, &dependency.to)).or_default().push(dependency);
    }
    levels.iter().flat_map(|(level, dependencies)| cycles_at(level.len(), dependencies)).collect()
}

/// The module that contains both, or the one that contains the other.
fn common(a: &[String], b: &[String]) -> Path {
    a.iter().zip(b).take_while(|(a, b)| a == b).map(|(a, _)| a.clone()).collect()
}

/// Cycles between a module's own file and its children; `depth` is the length of the module's path.
fn cycles_at(depth: usize, dependencies: &[Dependency]) -> Vec<Cycle> {
    let node = |path: &[String]| path[..path.len().min(depth + 1)].to_vec();
    let mut nodes: Vec<Path> = dependencies.iter().flat_map(|d| [node(&d.from), node(&d.to)]).collect();
    nodes.sort();
    nodes.dedup();
    let index = |path: &[String]| nodes.binary_search(&node(path)).unwrap_or(0);
    let edges: Vec<[usize; 2]> = dependencies.iter().map(|d| [index(&d.from), index(&d.to)]).collect();
    let cycle = |component: Vec<usize>| {
        let inside = edges.iter().zip(dependencies).filter(|(edge, _)| edge.iter().all(|n| component.contains(n)));
        let mut lines: Vec<String> = inside.map(|(_, d)| d.describe()).collect();
        lines.sort();
        lines.dedup();
        Cycle { nodes: component.iter().map(|&n| name(&nodes[n])).collect(), dependencies: lines }
    };
    components(nodes.len(), &edges).into_iter().filter(|component| component.len() > 1).map(cycle).collect()
}

impl Cycle {
    fn describe(&self, of: &str) -> String {
        format!("{of}: {} depend on each other:\n{}", self.nodes.join(", "), self.dependencies.join("\n"))
    }
}

#[cfg(test)]
mod tests;
