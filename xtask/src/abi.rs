//! The C library: installing it, and what its users' build systems make of it.
//!
//! The rest of the ABI's checks are tests of the package `pcmvs-ffi`; they skip what a machine has no tools for unless
//! `PCMVS_ALL_TOOLS` is set, as [`check`] does.

use crate::{
    Result,
    process::{cargo, program, root, run, target},
};
use std::{
    fs,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
};

/// Debian's packages that the checks need, and a program or file of each.
const PACKAGES: [(&str, &str); 6] = [
    ("gcc g++", "/usr/bin/g++"),
    ("clang", "/usr/bin/clang"),
    ("cmake", "/usr/bin/cmake"),
    ("pkg-config", "/usr/bin/pkg-config"),
    ("valgrind", "/usr/bin/valgrind"),
    ("abigail-tools", "/usr/bin/abidiff"),
];
/// Only the OpenCV example needs it: it is large.
const OPENCV: (&str, &str) = ("libopencv-dev", "/usr/include/opencv4/opencv2/opencv.hpp");

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The part of the version that programs are bound to: 0.y before 1.0, then the major version.
fn abi() -> String {
    let mut numbers = VERSION.split('.');
    match (numbers.next(), numbers.next()) {
        (Some("0"), Some(minor)) => format!("0.{minor}"),
        (Some(major), _) => major.to_owned(),
        (None, _) => VERSION.to_owned(),
    }
}

fn problem(path: &Path) -> impl Fn(std::io::Error) -> String + '_ {
    move |error| format!("{}: {error}", path.display())
}

/// Writes `include/pcmvs.h` anew from the sources.
pub fn header() -> Result<()> {
    let mut test = cargo("test --quiet -p pcmvs-ffi --test header header_is_up_to_date");
    run(test.env("PCMVS_WRITE_HEADER", "1")).map(drop)
}

/// Builds the library and installs it for C and C++ below `prefix`; the result may be moved.
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
    let shared = format!("libpcmvs.so.{VERSION}");
    copy(built.join("libpcmvs.a"), lib.join("libpcmvs.a"))?;
    copy(built.join("libpcmvs.so"), lib.join(&shared))?;
    for name in [format!("libpcmvs.so.{}", abi()), "libpcmvs.so".to_owned()] {
        let link = lib.join(name);
        if link.symlink_metadata().is_ok() {
            fs::remove_file(&link).map_err(problem(&link))?;
        }
        symlink(&shared, &link).map_err(problem(&link))?;
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

/// All checks of the C library, with every tool they can use.
pub fn check() -> Result<()> {
    set_up()?;
    run(cargo("test --quiet -p pcmvs-ffi").env("PCMVS_ALL_TOOLS", "1"))?;
    consumers()
}

/// Installs what is missing.
fn set_up() -> Result<()> {
    let missing = PACKAGES.iter().chain([&OPENCV]).filter(|(_, file)| !Path::new(file).exists());
    let missing: Vec<&str> = missing.map(|&(package, _)| package).collect();
    if missing.is_empty() {
        return Ok(());
    }
    run(&mut program("apt-get", "-qq update"))?;
    let install = format!("-qq install -y --no-install-recommends {}", missing.join(" "));
    run(program("apt-get", &install).env("DEBIAN_FRONTEND", "noninteractive")).map(drop)
}

/// Installs, moves what was installed, and builds and runs users' programs against it, from another folder.
fn consumers() -> Result<()> {
    let work = target().join("abi");
    if work.exists() {
        fs::remove_dir_all(&work).map_err(problem(&work))?;
    }
    let (first, prefix) = (work.join("first"), work.join("moved/prefix"));
    install(&first)?;
    fs::create_dir_all(work.join("moved")).map_err(problem(&work))?;
    fs::rename(&first, &prefix).map_err(problem(&first))?;
    let plain = work.join("plain");
    run(cargo("run --quiet --release -p pcmvs-ffi --example plain_capture").arg(&plain))?;

    let build = work.join("cmake");
    let mut configure = program("cmake", "-DCMAKE_BUILD_TYPE=Release -S");
    configure.arg(root().join("tests/install")).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    run(configure.arg(format!("-DEXAMPLES={}", root().join("examples").display())))?;
    run(program("cmake", "--build").arg(&build))?;

    let make = work.join("make");
    fs::create_dir_all(&make).map_err(problem(&make))?;
    let flags = |arguments: &str| {
        let mut command = program("pkg-config", arguments);
        run(command.arg("pcmvs").env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"))).map(|s| s.trim().to_owned())
    };
    let source = root().join("examples/c/reconstruct.c");
    let cc = |name: &str, before: &str, flags: &str| {
        let mut command = program("cc", &format!("-std=c99 {before} -o"));
        run(command.arg(make.join(name)).arg(&source).args(flags.split_whitespace()).current_dir(&make)).map(drop)
    };
    cc("c_shared", "", &flags("--cflags --libs")?)?;
    cc("c_static", "-static", &flags("--static --cflags --libs")?)?;

    let mut results = Vec::new();
    for name in ["c_pcmvs", "c_static", "cpp_pcmvs", "cpp_static"] {
        results.push((build.join(name), name.starts_with("cpp")));
    }
    results.extend(["c_shared", "c_static"].map(|name| (make.join(name), false)));
    let mut first: Option<Vec<u8>> = None;
    for (consumer, live) in results {
        let glb = consumer.with_extension("glb");
        let mut command = program(&consumer, "");
        command.arg(&plain).args(if live { &["2", "2"][..] } else { &[] }).arg(&glb);
        run(command.env("LD_LIBRARY_PATH", prefix.join("lib")))?;
        let bytes = fs::read(&glb).map_err(problem(&glb))?;
        if first.get_or_insert_with(|| bytes.clone()) != &bytes {
            return Err(format!("{} makes another mesh than the others", consumer.display()));
        }
    }
    Ok(())
}
