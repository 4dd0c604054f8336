//! Writes the header of the C library and installs the library.

use crate::{
    Result,
    process::{cargo, root, run, target},
};
use std::{
    env::consts::{DLL_PREFIX, DLL_SUFFIX},
    fs, io,
    path::{Path, PathBuf},
};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The part of the version that decides compatibility: 0.y before 1.0, the major version afterwards.
fn abi() -> String {
    let mut numbers = VERSION.split('.');
    match (numbers.next(), numbers.next()) {
        (Some("0"), Some(minor)) => format!("0.{minor}"),
        (Some(major), _) => major.to_owned(),
        (None, _) => VERSION.to_owned(),
    }
}

/// Name of the static library.
const STATIC: &str = if cfg!(target_env = "msvc") { "pcmvs.lib" } else { "libpcmvs.a" };

/// Name of the shared library as cargo builds it.
fn shared() -> String {
    format!("{DLL_PREFIX}pcmvs{DLL_SUFFIX}")
}

/// Adds the file's name to an error.
pub fn problem(path: &Path) -> impl Fn(io::Error) -> String + '_ {
    move |error| format!("{}: {error}", path.display())
}

/// Generates `include/pcmvs.h` from the sources.
pub fn header() -> Result<()> {
    let mut test = cargo("test --quiet -p pcmvs-ffi --test header header_is_up_to_date");
    run(test.env("PCMVS_WRITE_HEADER", "1")).map(drop)
}

/// Builds the library and installs it for C and C++ below `prefix`. The installed folder can be moved.
pub fn install(prefix: &Path) -> Result<()> {
    run(&mut cargo("build --quiet --release -p pcmvs-ffi"))?;
    let lib = prefix.join("lib");
    let folders = [prefix.join("include"), lib.join("pkgconfig"), lib.join("cmake/pcmvs")];
    folders.iter().try_for_each(|folder| fs::create_dir_all(folder).map_err(problem(folder)))?;
    let [include, pkgconfig, cmake] = folders;

    let copy = |from: PathBuf, to: PathBuf| fs::copy(&from, &to).map(drop).map_err(problem(&from));
    for header in ["pcmvs.h", "pcmvs.hpp"] {
        copy(root().join("include").join(header), include.join(header))?;
    }
    let built = target().join("release");
    // Only ELF libraries have the version in their names.
    let versioned = if cfg!(target_os = "linux") { format!("{}.{VERSION}", shared()) } else { shared() };
    copy(built.join(STATIC), lib.join(STATIC))?;
    copy(built.join(shared()), lib.join(&versioned))?;
    let links = if cfg!(target_os = "linux") { vec![format!("{}.{}", shared(), abi()), shared()] } else { vec![] };
    for name in links {
        let link = lib.join(name);
        if link.symlink_metadata().is_ok() {
            fs::remove_file(&link).map_err(problem(&link))?;
        }
        symlink(&versioned, &link).map_err(problem(&link))?;
    }
    let configure = |folder: &Path, name: &str| {
        let template = root().join("ffi/install").join(format!("{name}.in"));
        let text = fs::read_to_string(&template).map_err(problem(&template))?;
        let text = text.replace("@VERSION@", VERSION).replace("@ABI_PATTERN@", &abi().replace('.', "\\\\."));
        let path = folder.join(name);
        fs::write(&path, text.replace("@ABI@", &abi())).map_err(problem(&path))
    };
    configure(&pkgconfig, "pcmvs.pc")?;
    configure(&cmake, "pcmvs-config.cmake")?;
    configure(&cmake, "pcmvs-config-version.cmake")
}

#[cfg(unix)]
fn symlink(original: &str, link: &Path) -> io::Result<()> {
    std::os::unix::fs::symlink(original, link)
}

#[cfg(not(unix))]
fn symlink(original: &str, link: &Path) -> io::Result<()> {
    fs::copy(link.with_file_name(original), link).map(drop)
}
