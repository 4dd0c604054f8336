//! From a path in the source to the module that it leads to.

use super::{krate::Crate, module::Path};

/// A chain of re-exports longer than any that a person writes is a circle.
const LONGEST_CHAIN: u32 = 32;

/// What a path names.
enum Target {
    Module(Path),
    /// Something that this module defines.
    ItemOf(Path),
}

/// The module that a path leads to: the one it names, or the one that defines the item; None for another crate's, and
/// for names that are local to an item.
pub fn resolve(of: &Crate, from: &[String], path: &[String]) -> Option<Path> {
    match target(of, from, path, LONGEST_CHAIN)? {
        Target::Module(module) | Target::ItemOf(module) => Some(module),
    }
}

fn target(of: &Crate, from: &[String], path: &[String], chain: u32) -> Option<Target> {
    let chain = chain.checked_sub(1)?;
    let mut module = from.to_vec();
    let mut rest = path;
    // `crate`, `self` and any number of `super`.
    while let Some((first, others)) = rest.split_first() {
        match first.as_str() {
            "crate" => module.clear(),
            "self" => {}
            "super" => _ = module.pop()?,
            _ => break,
        }
        rest = others;
    }
    let mut absolute = rest.len() < path.len();
    while let Some((name, others)) = rest.split_first() {
        let (content, _) = of.modules.get(&module)?;
        let child: Path = module.iter().chain([name]).cloned().collect();
        if of.modules.contains_key(&child) {
            module = child;
        } else if content.items.contains(name) {
            return Some(Target::ItemOf(module));
        } else if let Some(import) = content.imports.get(name) {
            match target(of, &module, import, chain)? {
                Target::Module(found) => module = found,
                item => return Some(item),
            }
        } else {
            let globs = content.globs.iter().filter_map(|glob| match target(of, &module, glob, chain)? {
                Target::Module(found) if found != module => target(of, &found, rest, chain),
                _ => None,
            });
            // What no declaration shows is made by a macro.
            return globs.into_iter().next().or(absolute.then_some(Target::ItemOf(module.clone())));
        }
        absolute = true;
        rest = others;
    }
    Some(Target::Module(module))
}
