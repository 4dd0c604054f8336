//! Installs what a machine lacks.

use crate::{
    Result,
    process::{program, run},
};
use std::{fs, path::Path};

/// Debian's packages (names separated by spaces), and a file that is there if they are.
pub type Package = (&'static str, &'static str);

/// The browser.
pub const CHROMIUM: Package = ("chromium", "/usr/bin/chromium");

/// Installs those of Debian's packages whose file is missing.
pub fn debian(packages: &[Package]) -> Result<()> {
    let missing = packages.iter().filter(|(_, file)| !Path::new(file).exists());
    let missing: Vec<&str> = missing.map(|&(names, _)| names).collect();
    if missing.is_empty() {
        return Ok(());
    }
    run(&mut program("apt-get", "-qq update"))?;
    let install = format!("-qq install -y --no-install-recommends {}", missing.join(" "));
    run(program("apt-get", &install).env("DEBIAN_FRONTEND", "noninteractive")).map(drop)
}

/// Installs the standard libraries of rustup's targets that are missing.
pub fn rust_targets(triples: &[&str]) -> Result<()> {
    let installed = run(&mut program("rustup", "target list --installed"))?;
    let missing: Vec<&&str> = triples.iter().filter(|t| !installed.lines().any(|line| line == **t)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    run(program("rustup", "target add").args(missing)).map(drop)
}

/// Installs what a folder's package-lock.json says, unless that has been done.
pub fn node_packages(folder: &Path) -> Result<()> {
    let fail = |e| format!("{}: {e}", folder.display());
    let lock = fs::read(folder.join("package-lock.json")).map_err(fail)?;
    let done = folder.join("node_modules/.installed-lock");
    if fs::read(&done).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    run(program("npm", "ci --no-audit --no-fund").current_dir(folder))?;
    fs::write(&done, &lock).map_err(fail)
}
