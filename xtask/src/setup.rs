//! What checks need that a machine may lack, and how it is installed.

use crate::{
    Result,
    process::{program, root, run, target},
};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Debian's packages (names separated by spaces), and a file that is there if they are.
pub type Package = (&'static str, &'static str);

/// The browser.
pub const CHROMIUM: Package = ("chromium", "/usr/bin/chromium");

/// The compiler that builds the standard library itself where rustup's server cannot be reached.
pub const DEBIAN_COMPILER: Package = ("rustc-web cargo-web rust-web-src", "/usr/lib/rustlib/src/rust/library");

/// Something that a check needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    Debian(Package),
    /// A component of rustup's toolchain, and the arguments with which Cargo shows that it is there.
    Component(&'static str, &'static str),
    /// The standard library of a target, from rustup only.
    Target(&'static str),
    /// The standard library of a target, from rustup or built by Debian's compiler.
    TargetOrDebian(&'static str),
    /// The source of the standard library: rustup's, or that of Debian's compiler where rustup's server cannot be reached.
    LibrarySource,
    /// Another version of Rust.
    Toolchain(&'static str),
    /// A component of the nightly compiler that is a command of Cargo.
    Nightly(&'static str),
    /// A program of crates.io, and the arguments with which Cargo shows that it is there.
    Crate(&'static str, &'static str),
    /// The packages of a folder's package-lock.json.
    Npm(&'static str),
    /// Python's packages.
    Pip(Environment),
}

impl Need {
    pub fn is_met(self) -> bool {
        match self {
            Self::Debian((_, file)) => Path::new(file).exists(),
            Self::Component(_, arguments) | Self::Crate(_, arguments) => run(&mut program("cargo", arguments)).is_ok(),
            Self::Target(triple) => has_target(triple),
            Self::TargetOrDebian(triple) => has_target(triple) || Path::new(DEBIAN_COMPILER.1).exists(),
            Self::LibrarySource => has_library_source() || Path::new(DEBIAN_COMPILER.1).exists(),
            Self::Toolchain(version) => run(&mut program("rustup", &format!("run {version} rustc --version"))).is_ok(),
            Self::Nightly(name) => run(&mut program("rustup", &format!("run nightly cargo {name} --version"))).is_ok(),
            Self::Npm(folder) => npm_is_done(&root().join(folder)),
            Self::Pip(environment) => environment.is_installed(),
        }
    }

    /// The command that installs it, for people.
    pub fn remedy(self) -> String {
        match self {
            Self::Debian((names, _)) => format!("apt-get install {names}"),
            Self::Component(name, _) => format!("rustup component add {name}"),
            Self::Target(triple) | Self::TargetOrDebian(triple) => format!("rustup target add {triple}"),
            Self::LibrarySource => "rustup component add rust-src".to_owned(),
            Self::Toolchain(version) => format!("rustup toolchain install {version}"),
            Self::Nightly(name) => {
                format!("rustup toolchain install nightly --component {name} --component rust-src")
            }
            Self::Crate(name, _) => format!("cargo install {name} --locked"),
            Self::Npm(folder) => format!("npm ci in {folder}"),
            Self::Pip(Environment { python, packages, .. }) => {
                format!("pip install {packages}, in a virtual environment ({python} -m venv)")
            }
        }
    }

    /// Installs it unless it is there.
    pub fn install(self) -> Result<()> {
        match self {
            _ if self.is_met() => Ok(()),
            Self::Debian(package) => debian(&[package]),
            Self::Component(name, _) => run(program("rustup", "component add").arg(name)).map(drop),
            Self::Target(triple) => rust_target(triple),
            Self::TargetOrDebian(triple) => rust_target(triple).or_else(|_| debian(&[DEBIAN_COMPILER])),
            Self::LibrarySource => run(&mut program("rustup", "component add rust-src")).map(drop),
            Self::Toolchain(version) => {
                let install = format!("toolchain install {version} --profile minimal --no-self-update");
                run(&mut program("rustup", &install)).map(drop)
            }
            Self::Nightly(name) => {
                let install = "toolchain install nightly --profile minimal --no-self-update --component rust-src";
                run(program("rustup", install).args(["--component", name])).map(drop)
            }
            Self::Crate(name, _) => run(program("cargo", "install --quiet --locked").arg(name)).map(drop),
            Self::Npm(folder) => node_packages(&root().join(folder)),
            Self::Pip(environment) => environment.install(),
        }
    }
}

/// The commands that install what is missing, each once.
pub fn missing(needs: &[Need]) -> Vec<String> {
    let mut remedies: Vec<String> = needs.iter().filter(|need| !need.is_met()).map(|need| need.remedy()).collect();
    remedies.sort();
    remedies.dedup();
    remedies
}

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

/// Debian's Python has no virtual environments without it.
const VENV: Package = ("python3 python3-venv", "/usr/share/doc/python3-venv");

/// Python's packages, in a virtual environment of their own in the target folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Environment {
    /// Name of its folder.
    pub name: &'static str,
    /// The Python that it is for.
    pub python: &'static str,
    /// Requirements, separated by spaces.
    pub packages: &'static str,
}

impl Environment {
    fn folder(self) -> PathBuf {
        target().join("environments").join(self.name)
    }

    /// A program of the environment.
    pub fn tool(self, name: &str) -> PathBuf {
        self.folder().join("bin").join(name)
    }

    /// Where the environment notes what is installed in it.
    fn note(self) -> PathBuf {
        self.folder().join("installed-requirements")
    }

    fn is_installed(self) -> bool {
        fs::read_to_string(self.note()).is_ok_and(|installed| installed == self.packages)
    }

    fn install(self) -> Result<()> {
        let make = || run(program(self.python, "-m venv --clear").arg(self.folder()));
        if let Err(why) = make() {
            debian(&[VENV]).and_then(|()| make()).map_err(|_| why)?;
        }
        let options = "install --quiet --disable-pip-version-check --no-cache-dir";
        run(program(self.tool("pip"), options).args(self.packages.split_whitespace()))?;
        fs::write(self.note(), self.packages).map_err(|e| format!("{}: {e}", self.note().display()))
    }
}

fn has_target(triple: &str) -> bool {
    run(&mut program("rustup", "target list --installed")).is_ok_and(|list| list.lines().any(|line| line == triple))
}

fn has_library_source() -> bool {
    let sysroot = run(&mut program("rustc", "--print sysroot"));
    sysroot.is_ok_and(|path| Path::new(path.trim()).join("lib/rustlib/src/rust/library").exists())
}

fn rust_target(triple: &str) -> Result<()> {
    run(program("rustup", "target add").arg(triple)).map(drop)
}

/// Where a folder keeps a copy of the package-lock.json that was installed.
const INSTALLED_LOCK: &str = "node_modules/.installed-lock";

fn npm_is_done(folder: &Path) -> bool {
    let lock = fs::read(folder.join("package-lock.json"));
    lock.is_ok_and(|lock| fs::read(folder.join(INSTALLED_LOCK)).is_ok_and(|installed| installed == lock))
}

/// Installs what a folder's package-lock.json lists, unless that has been done.
pub fn node_packages(folder: &Path) -> Result<()> {
    if npm_is_done(folder) {
        return Ok(());
    }
    run(program("npm", "ci --no-audit --no-fund").current_dir(folder))?;
    let copied = fs::copy(folder.join("package-lock.json"), folder.join(INSTALLED_LOCK));
    copied.map(drop).map_err(|e| format!("{}: {e}", folder.display()))
}
