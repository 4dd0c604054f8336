//! The long checks of the C library: all tools, the build systems of users, and the overhead.
//!
//! The quick checks are tests of the package `pcmvs-ffi` and run with all other tests. They skip what needs a missing
//! tool, unless `PCMVS_ALL_TOOLS` is set, as it is here.

use crate::{
    Result,
    abi::{install, problem},
    process::{cargo, program, root, run, target},
    setup::Need,
    steps::{Outcome, Steps, passed},
};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// What the checks need. OpenCV, which is large, is only for its example.
pub const NEEDS: [Need; 7] = [
    Need::Debian(("gcc g++", "/usr/bin/g++")),
    Need::Debian(("clang", "/usr/bin/clang")),
    Need::Debian(("cmake", "/usr/bin/cmake")),
    Need::Debian(("pkg-config", "/usr/bin/pkg-config")),
    Need::Debian(("valgrind", "/usr/bin/valgrind")),
    Need::Debian(("abigail-tools", "/usr/bin/abidiff")),
    Need::Debian(("libopencv-dev", "/usr/include/opencv4/opencv2/opencv.hpp")),
];

/// Runs all checks of the C library.
pub fn check(steps: &mut Steps) -> Result<()> {
    steps.step_with(&NEEDS, "C: tools", || NEEDS.iter().try_for_each(|need| need.install()).map(passed))?;
    steps.step_with(&NEEDS, "C: tests, including the long ones", || {
        run(cargo("test --quiet -p pcmvs-ffi -- --include-ignored").env("PCMVS_ALL_TOOLS", "1")).map(passed)
    })?;
    steps.step_with(&NEEDS[..4], "C: installed, moved and linked", || consumers().map(Outcome::Passed))?;
    steps.step_with(&NEEDS[..1], "C: ThreadSanitizer", threads)?;
    steps.step("progress at least every 50 ms", || {
        let printed = run(&mut cargo("run --quiet --release -p facts --example gaps"))?;
        Ok(Outcome::Passed(printed.split_whitespace().collect::<Vec<_>>().join(" ").replace(" ms", " ms,")))
    })?;
    steps.step("C: overhead over Rust below 1 %", || {
        let printed = run(&mut cargo("run --quiet --release -p pcmvs-ffi --example measure -- 6 96 72 40"))?;
        Ok(Outcome::Passed(printed.lines().next().unwrap_or_default().to_owned()))
    })
}

/// Folder for programs and installed copies.
fn work() -> PathBuf {
    target().join("abi")
}

/// Installs the library, moves it, and builds and runs programs against it from another folder.
fn consumers() -> Result<String> {
    let work = work();
    if work.exists() {
        fs::remove_dir_all(&work).map_err(problem(&work))?;
    }
    let (first, prefix) = (work.join("first"), work.join("moved/prefix"));
    install(&first, None)?;
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
    for (consumer, live) in &results {
        let glb = consumer.with_extension("glb");
        let mut command = program(consumer, "");
        command.arg(&plain).args(if *live { &["2", "2"][..] } else { &[] }).arg(&glb);
        run(command.env("LD_LIBRARY_PATH", prefix.join("lib")))?;
        let bytes = fs::read(&glb).map_err(problem(&glb))?;
        if first.get_or_insert_with(|| bytes.clone()) != &bytes {
            return Err(format!("{} makes a different mesh than the other programs", consumer.display()));
        }
    }
    Ok(format!("{} programs", results.len()))
}

/// Runs the threaded programs under ThreadSanitizer. The library and Rust's standard library must be instrumented, too, and
/// are built with options of nightly compilers. Valgrind's helgrind and drd do not understand the futexes of Rust's locks.
fn threads() -> Result<Outcome> {
    const TARGET: &str = "x86_64-unknown-linux-gnu";
    if !cfg!(all(target_arch = "x86_64", target_os = "linux", target_env = "gnu")) {
        return Ok(Outcome::Skipped(format!("needs {TARGET}")));
    }
    if run(&mut program("rustup", "component add rust-src")).is_err() {
        return Ok(Outcome::Skipped("rustup has no rust-src".to_owned()));
    }
    let built = target().join("thread-sanitizer");
    let mut build = cargo("rustc --quiet -p pcmvs-ffi --lib --crate-type staticlib -Zbuild-std=std,panic_unwind");
    build.env("RUSTC_BOOTSTRAP", "1").env("RUSTFLAGS", "-Zsanitizer=thread -Zexternal-clangrt");
    run(build.args(["--target", TARGET]).env("CARGO_TARGET_DIR", &built))?;
    let sysroot = run(&mut program("rustc", "--print sysroot"))?;
    let libraries = Path::new(sysroot.trim()).join("lib/rustlib").join(TARGET).join("lib");
    let entries = fs::read_dir(&libraries).map_err(problem(&libraries))?.flatten().map(|entry| entry.path());
    let runtime = entries.into_iter().find(|path| path.to_string_lossy().ends_with("_rt.tsan.a"));
    let runtime = runtime.ok_or_else(|| {
        format!("{} does not contain the runtime of ThreadSanitizer: reinstall the toolchain", libraries.display())
    })?;

    let sanitized = |source: &str| -> Result<PathBuf> {
        let binary = built.join(Path::new(source).file_stem().unwrap_or_default());
        let object = binary.with_extension("o");
        let mut compile = program("g++", "-std=c++17 -pthread -O1 -g -fsanitize=thread -I include -I examples/c -c");
        run(compile.arg(source).arg("-o").arg(&object))?;
        // g++ would link its own runtime in addition, so the flag is not given here.
        let mut link = program("g++", "-pthread -Wl,--export-dynamic");
        link.arg(&object).arg("-Wl,--whole-archive").arg(&runtime).arg("-Wl,--no-whole-archive");
        link.arg(built.join(TARGET).join("debug/libpcmvs.a")).args(["-ldl", "-lm", "-lrt", "-lresolv"]);
        run(link.arg("-o").arg(&binary)).map(|_| binary)
    };
    let plain = built.join("plain");
    run(cargo("run --quiet --release -p pcmvs-ffi --example plain_capture").arg(&plain).args(["4", "40", "32"]))?;
    let (live, threads) = (sanitized("examples/cpp/live.cpp")?, sanitized("tests/cpp/threads.cpp")?);
    run(program(live, "").arg(&plain).args(["2", "3"]).arg(built.join("live.glb")))?;
    run(program(&threads, "").arg(&plain))?;
    match run(program(&threads, "").arg(&plain).arg("race")) {
        Err(found) if found.contains("data race") && found.contains("pcmvs_rig_camera_count") => {
            Ok(Outcome::Passed("no race in 2 programs, the deliberate race found".to_owned()))
        }
        _ => Err("ThreadSanitizer does not see a race inside the library".to_owned()),
    }
}
