//! A use of one module by another.

use super::{krate::Crate, module::Path, resolve::resolve};

pub struct Dependency {
    pub from: Path,
    pub to: Path,
    /// File, line and the path as it is written there.
    pub place: String,
}

impl Dependency {
    pub fn describe(&self) -> String {
        format!("  {} -> {}: {}", name(&self.from), name(&self.to), self.place)
    }
}

/// Every use of one module by another.
pub fn dependencies(of: &Crate) -> Vec<Dependency> {
    let mut found = Vec::new();
    for (from, (module, file)) in &of.modules {
        for used in &module.uses {
            let Some(to) = resolve(of, from, &used.path) else { continue };
            if to != *from && !(used.exported && to.starts_with(from)) {
                let place = format!("{}:{} uses {}", file.display(), used.line, used.path.join("::"));
                found.push(Dependency { from: from.clone(), to, place });
            }
        }
    }
    found
}

/// A module's path for people.
pub fn name(path: &[String]) -> String {
    if path.is_empty() { String::from("crate") } else { path.join("::") }
}
