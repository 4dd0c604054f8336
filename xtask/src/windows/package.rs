//! The installed library as a project on Windows finds it with CMake: DLL, import library, static library and headers.

use super::machine::{CC, CXX, TRIPLE, compare, empty, windows_path, wine};
use crate::{
    Result,
    abi::{install, problem},
    process::{cargo, program, root, run},
};
use std::fs;

/// Installs the library, moves it, builds the examples against it from another folder, and runs them.
pub fn check() -> Result<String> {
    let folder = empty("package")?;
    let (first, prefix) = (folder.join("first"), folder.join("moved"));
    install(&first, Some(TRIPLE))?;
    fs::rename(&first, &prefix).map_err(problem(&first))?;
    let toolchain = folder.join("toolchain.cmake");
    let text = format!(
        "set(CMAKE_SYSTEM_NAME Windows)\nset(CMAKE_C_COMPILER {CC})\nset(CMAKE_CXX_COMPILER {CXX})\n\
         set(CMAKE_FIND_ROOT_PATH \"{}\")\nset(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)\n",
        prefix.display()
    );
    fs::write(&toolchain, text).map_err(problem(&toolchain))?;
    let build = folder.join("build");
    let mut configure = program("cmake", "-DCMAKE_BUILD_TYPE=Release -S");
    configure.arg(root().join("tests/install")).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_TOOLCHAIN_FILE={}", toolchain.display()));
    run(configure.arg(format!("-DEXAMPLES={}", root().join("examples").display())))?;
    run(program("cmake", "--build").arg(&build))?;
    // Windows finds libraries beside programs.
    let dll = prefix.join("bin/pcmvs.dll");
    fs::copy(&dll, build.join("pcmvs.dll")).map_err(problem(&dll))?;

    let plain = folder.join("plain");
    run(cargo("run --quiet --release -p pcmvs-ffi --example plain_capture").arg(&plain))?;
    let programs = ["c_pcmvs", "c_static", "cpp_pcmvs", "cpp_static"];
    for name in programs {
        let mut command = wine(&build.join(name).with_extension("exe"))?;
        command.arg(windows_path(&plain)).args(if name.starts_with("cpp") { &["2", "2"][..] } else { &[] });
        run(command.arg(windows_path(&build.join(name).with_extension("glb"))))?;
        compare(&build.join("c_pcmvs.glb"), &build.join(name).with_extension("glb"))?;
    }
    Ok(format!("{} programs", programs.len()))
}
