//! All modules of a crate.

use super::module::{Module, Path};
use crate::Result;
use std::{
    collections::BTreeMap,
    path::{self, PathBuf},
};
use syn::Item;

/// Reads a file.
pub type Read<'a> = &'a dyn Fn(&path::Path) -> Result<String>;

/// A crate's modules, each with the file that holds it.
#[derive(Default)]
pub struct Crate {
    pub modules: BTreeMap<Path, (Module, PathBuf)>,
}

impl Crate {
    /// Reads a crate from its root file.
    pub fn parse(root: &path::Path, read: Read) -> Result<Self> {
        let mut found = Self::default();
        let folder = root.parent().unwrap_or(path::Path::new(""));
        found.add_file(Path::new(), root, folder, read)?;
        Ok(found)
    }

    /// Adds a file's module and those below it, whose files are in `folder`.
    fn add_file(&mut self, name: Path, file: &path::Path, folder: &path::Path, read: Read) -> Result<()> {
        let items = Module::parse(&read(file)?).map_err(|e| format!("{}: {e}", file.display()))?;
        self.add(name, &items, file, folder, read)
    }

    fn add(&mut self, name: Path, items: &[Item], file: &path::Path, folder: &path::Path, read: Read) -> Result<()> {
        let mut module = Module::new(items);
        for (child, content) in std::mem::take(&mut module.children) {
            let below = folder.join(&child);
            let path: Path = name.iter().cloned().chain([child.clone()]).collect();
            match content {
                Some(items) => self.add(path, &items, file, &below, read)?,
                None => {
                    let files = [folder.join(format!("{child}.rs")), below.join("mod.rs")];
                    let chosen = files.iter().find(|file| read(file).is_ok()).unwrap_or(&files[0]);
                    self.add_file(path, chosen, &below, read)?;
                }
            }
        }
        self.modules.insert(name, (module, file.to_path_buf()));
        Ok(())
    }
}
