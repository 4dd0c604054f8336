//! Writes the header of the C library and installs the library.

use crate::{
    Result,
    process::{cargo, root, run, target},
};
use std::{
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

/// The files of the library on a system, as cargo names them.
struct Library {
    shared: &'static str,
    /// The static library.
    archive: &'static str,
    /// The import library, with which programs link on Windows. Elsewhere they link the shared library itself.
    import: Option<&'static str>,
    /// What programs that use the static library must link besides it, separated by semicolons.
    needed: &'static str,
    /// The same as flags of a linker.
    flags: &'static str,
}

const LINUX: Library = Library {
    shared: "libpcmvs.so",
    archive: "libpcmvs.a",
    import: None,
    needed: "Threads::Threads;${CMAKE_DL_LIBS};m",
    flags: "-lpthread -ldl -lm",
};
const MACOS: Library = Library { shared: "libpcmvs.dylib", needed: "", flags: "", ..LINUX };
const MINGW: Library = Library {
    shared: "pcmvs.dll",
    archive: "libpcmvs.a",
    import: Some("libpcmvs.dll.a"),
    needed: "ntdll;userenv;ws2_32;dbghelp",
    flags: "-lntdll -luserenv -lws2_32 -ldbghelp",
};
const MSVC: Library = Library { archive: "pcmvs.lib", import: Some("pcmvs.dll.lib"), ..MINGW };

impl Library {
    /// The files on the system of a triple, or on this one.
    fn of(triple: Option<&str>) -> Self {
        match triple {
            Some(triple) if triple.ends_with("windows-msvc") => MSVC,
            Some(triple) if triple.contains("windows") => MINGW,
            Some(triple) if triple.contains("apple") => MACOS,
            None if cfg!(target_env = "msvc") => MSVC,
            None if cfg!(windows) => MINGW,
            None if cfg!(target_os = "macos") => MACOS,
            _ => LINUX,
        }
    }

    /// Only ELF libraries have the version in their names.
    fn is_elf(&self) -> bool {
        self.shared == LINUX.shared
    }

    /// Path of the installed shared library below the prefix. Windows finds libraries beside programs.
    fn shared_path(&self) -> String {
        match (self.is_elf(), self.import) {
            (true, _) => format!("lib/{}.{VERSION}", self.shared),
            (_, Some(_)) => format!("bin/{}", self.shared),
            _ => format!("lib/{}", self.shared),
        }
    }

    /// What CMake must know to link the shared library, besides its place.
    fn property(&self) -> String {
        match self.import {
            Some(import) => format!("IMPORTED_IMPLIB \"${{_pcmvs_prefix}}/lib/{import}\""),
            None if self.is_elf() => format!("IMPORTED_SONAME \"{}.{}\"", self.shared, abi()),
            None => format!("IMPORTED_SONAME \"@rpath/{}\"", self.shared),
        }
    }
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

/// Builds the library, for another system if a triple is given, and installs it for C and C++ below `prefix`. The installed
/// folder can be moved.
pub fn install(prefix: &Path, triple: Option<&str>) -> Result<()> {
    let mut build = cargo("build --quiet --release -p pcmvs-ffi");
    triple.iter().for_each(|triple| _ = build.args(["--target", triple]));
    run(&mut build)?;
    let library = Library::of(triple);
    let lib = prefix.join("lib");
    let folders = [prefix.join("include"), lib.join("pkgconfig"), lib.join("cmake/pcmvs")];
    folders.iter().try_for_each(|folder| fs::create_dir_all(folder).map_err(problem(folder)))?;
    let [include, pkgconfig, cmake] = folders;

    let copy = |from: PathBuf, to: PathBuf| fs::copy(&from, &to).map(drop).map_err(problem(&from));
    for header in ["pcmvs.h", "pcmvs.hpp"] {
        copy(root().join("include").join(header), include.join(header))?;
    }
    let built = target().join(triple.unwrap_or_default()).join("release");
    let shared = prefix.join(library.shared_path());
    shared.parent().map_or(Ok(()), fs::create_dir_all).map_err(problem(&shared))?;
    copy(built.join(library.shared), shared)?;
    for name in [Some(library.archive), library.import].into_iter().flatten() {
        copy(built.join(name), lib.join(name))?;
    }
    let links = if library.is_elf() {
        vec![format!("{}.{}", library.shared, abi()), library.shared.to_owned()]
    } else {
        vec![]
    };
    for name in links {
        let link = lib.join(name);
        if link.symlink_metadata().is_ok() {
            fs::remove_file(&link).map_err(problem(&link))?;
        }
        symlink(&format!("{}.{VERSION}", library.shared), &link).map_err(problem(&link))?;
    }
    let configure = |folder: &Path, name: &str| {
        let template = root().join("ffi/install").join(format!("{name}.in"));
        let text = fs::read_to_string(&template).map_err(problem(&template))?;
        let text = text.replace("@VERSION@", VERSION).replace("@ABI_PATTERN@", &abi().replace('.', "\\\\."));
        let text = text.replace("@SHARED@", &library.shared_path()).replace("@PROPERTY@", &library.property());
        let text = text
            .replace("@STATIC@", library.archive)
            .replace("@NEEDED@", library.needed)
            .replace("@FLAGS@", library.flags);
        let path = folder.join(name);
        fs::write(&path, text).map_err(problem(&path))
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
