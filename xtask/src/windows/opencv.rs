//! The example with OpenCV. Debian has no OpenCV for MinGW-w64, so that the parts that it needs are built from Debian's source.

use super::{
    machine::{CC, CXX, built, compare, empty, windows_path, wine, work},
    programs::{System, compile},
};
use crate::{
    Result,
    abi::problem,
    process::{cargo, program, root, run},
    setup::Need,
    steps::Outcome,
};
use std::{fs, path::Path, process::Command};

/// OpenCV reads compressed files with it.
pub const ZLIB: Need = Need::Debian(("libz-mingw-w64-dev", "/usr/x86_64-w64-mingw32/lib/libz.a"));

const SOURCE: &str = "http://deb.debian.org/debian/pool/main/o/opencv/opencv_4.6.0+dfsg.orig.tar.xz";
const SHA256: &str = "40a59ba7e5c18a43652de0a08733c9843a39bba619b1f3e26a5fac4a6f041423";
/// In the order in which they are linked: each one uses those after it.
const MODULES: [&str; 3] = ["imgcodecs", "imgproc", "core"];
/// What the example can do without: it reads PPM and PGM files.
const WITHOUT: [&str; 17] = [
    "PNG", "JPEG", "TIFF", "WEBP", "OPENJPEG", "JASPER", "OPENEXR", "IPP", "ITT", "OPENCL", "DIRECTX", "PROTOBUF",
    "QUIRC", "ADE", "LAPACK", "EIGEN", "FFMPEG",
];

/// Builds the example, and compares its file with that of the example in C on this machine.
pub fn check() -> Result<Outcome> {
    let opencv = work().join("opencv");
    if let Err(why) = ZLIB.install().and_then(|()| download(&opencv)) {
        return Ok(Outcome::Skipped(why));
    }
    build(&opencv)?;
    let folder = empty("opencv")?;
    let plain = folder.join("plain");
    run(cargo("run --quiet --release -p pcmvs-ffi --example plain_capture").arg(&plain))?;

    let exe = folder.join("opencv.exe");
    let mut cxx = program(CXX, "-std=c++17 -O1 -Wall -Wextra -Werror -I include examples/cpp/opencv.cpp -o");
    cxx.current_dir(root()).arg(&exe);
    let headers = MODULES.iter().map(|module| opencv.join("source/modules").join(module).join("include"));
    // OpenCV's headers cause warnings.
    for headers in headers.chain([opencv.join("source/include"), opencv.join("build")]) {
        cxx.arg("-isystem").arg(headers);
    }
    cxx.arg(built().join("libpcmvs.dll.a"));
    cxx.args(MODULES.map(|module| opencv.join(format!("build/lib/libopencv_{module}460.a"))));
    run(cxx.arg("/usr/x86_64-w64-mingw32/lib/libz.a").arg("-lpthread"))?;

    let [here, there] = ["here.glb", "there.glb"].map(|name| folder.join(name));
    run(wine(&exe)?.args([&plain.join("calibration.yml"), &plain, &there].map(|path| windows_path(path))))?;
    let in_c = folder.join("reconstruct");
    compile(System::This, "examples/c/reconstruct.c", &in_c)?;
    run(program(&in_c, "").args([&plain, &here]))?;
    compare(&here, &there)?;
    Ok(Outcome::Passed(String::from("the same file")))
}

/// Downloads the source unless it is there.
fn download(folder: &Path) -> Result<()> {
    let source = folder.join("source");
    if source.join("CMakeLists.txt").exists() {
        return Ok(());
    }
    fs::create_dir_all(&source).map_err(problem(&source))?;
    let archive = folder.join("opencv.tar.xz");
    run(program("curl", "--fail --silent --show-error --location --output").arg(&archive).arg(SOURCE))?;
    if !run(program("sha256sum", "").arg(&archive))?.starts_with(SHA256) {
        return Err(format!("{SOURCE} has another SHA-256 than {SHA256}"));
    }
    run(program("tar", "--extract --strip-components=1 --file").arg(&archive).arg("--directory").arg(&source)).map(drop)
}

/// Builds the modules. What has been built already stays.
fn build(folder: &Path) -> Result<()> {
    run(&mut configured(folder))?;
    run(program("cmake", "--build").arg(folder.join("build")).args(["--parallel", "2"])).map(drop)
}

fn configured(folder: &Path) -> Command {
    let mut cmake = program("cmake", "-DCMAKE_BUILD_TYPE=Release -DCMAKE_SYSTEM_NAME=Windows -S");
    cmake.arg(folder.join("source")).arg("-B").arg(folder.join("build"));
    cmake.args([format!("-DCMAKE_C_COMPILER={CC}"), format!("-DCMAKE_CXX_COMPILER={CXX}")]);
    cmake.args(["-DCMAKE_SYSTEM_PROCESSOR=x86_64", "-DCMAKE_FIND_ROOT_PATH=/usr/x86_64-w64-mingw32"]);
    cmake.args(["LIBRARY", "INCLUDE"].map(|kind| format!("-DCMAKE_FIND_ROOT_PATH_MODE_{kind}=ONLY")));
    cmake.arg("-DCMAKE_RC_COMPILER=x86_64-w64-mingw32-windres");
    cmake.arg(format!("-DBUILD_LIST={}", MODULES.join(",")));
    cmake.args(
        ["SHARED_LIBS", "ZLIB", "TESTS", "PERF_TESTS", "opencv_apps", "JAVA"].map(|n| format!("-DBUILD_{n}=OFF")),
    );
    cmake.args(WITHOUT.map(|name| format!("-DWITH_{name}=OFF")));
    cmake
}
