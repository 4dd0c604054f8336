//! Programs in C and C++: the examples, and the tests that the package `pcmvs-ffi` runs on this machine.

use super::machine::{CC, CXX, built, compare, empty, windows_path, wine};
use crate::{
    Result,
    process::{cargo, program, root, run, target},
};
use std::path::{Path, PathBuf};

/// The captures that the programs read: the name of each, and the arguments with which the example `plain_capture` writes it.
/// `take` and `part` have several frames, and each is written to a folder of its own: `take0`, `take1`, `take2`.
const CAPTURES: [(&str, &str); 5] =
    [("plain", ""), ("tiny", "4 40 32"), ("turned", "turned"), ("take", "3"), ("part", "lacking")];

/// Programs that check themselves, and their arguments. A capture's name stands for its folder.
const TESTS: [(&str, &str); 11] = [
    ("tests/c/misuse.c", "plain"),
    ("tests/c/hostile.c", "tiny 1 2000"),
    ("tests/c/early.c", "tiny"),
    ("tests/c/results.c", "plain"),
    ("tests/c/warnings.c", "plain"),
    ("tests/c/silhouettes.c", ""),
    ("tests/c/soak.c", "tiny 50 1"),
    ("tests/c/starved.c", "tiny 997"),
    ("tests/c/calibration.c", "turned"),
    ("tests/cpp/wrapper.cpp", "plain"),
    ("tests/cpp/threads.cpp", "tiny"),
];

/// Programs that write a file, whose bytes are compared. `OUT` stands for it.
const WRITERS: [(&str, &str); 7] = [
    ("examples/c/reconstruct.c", "plain OUT"),
    ("examples/cpp/live.cpp", "plain 2 3 OUT"),
    ("examples/cpp/refine.cpp", "turned OUT"),
    ("tests/c/forms.c", "plain OUT"),
    ("tests/c/allocator.c", "tiny OUT growing"),
    ("tests/c/steady.c", "take0 take1 take2 OUT"),
    ("tests/c/lost_part.c", "part0 part1 part2 OUT"),
];

/// Compiles and runs all of them. The example with OpenCV has a check of its own.
pub fn check() -> Result<String> {
    let folder = empty("programs")?;
    for (name, arguments) in CAPTURES {
        let mut capture = cargo("run --quiet --release -p pcmvs-ffi --example plain_capture");
        run(capture.arg(folder.join(name)).args(arguments.split_whitespace()))?;
    }
    for (source, arguments) in TESTS {
        run_on(System::Windows, &folder, source, arguments)?;
    }
    for (source, arguments) in WRITERS {
        let here = run_on(System::This, &folder, source, arguments)?;
        compare(&here, &run_on(System::Windows, &folder, source, arguments)?)?;
    }
    Ok(format!("{} test themselves, {} write the same files", TESTS.len(), WRITERS.len()))
}

/// Where a program runs.
#[derive(Clone, Copy, PartialEq)]
pub enum System {
    This,
    Windows,
}

/// Compiles and runs a program. Returns the path of the file that it may write.
fn run_on(system: System, folder: &Path, source: &str, arguments: &str) -> Result<PathBuf> {
    let name = Path::new(source).file_stem().unwrap_or_default().to_string_lossy();
    let (suffix, end) = if system == System::Windows { (" of Windows", ".exe") } else { ("", "") };
    let [program_file, out] = [end, ".glb"].map(|end| folder.join(format!("{name}{suffix}{end}")));
    compile(system, source, &program_file)?;
    let mut command = if system == System::Windows { wine(&program_file)? } else { program(&program_file, "") };
    for argument in arguments.split_whitespace() {
        let path = if argument == "OUT" { out.clone() } else { folder.join(argument) };
        match system {
            _ if argument != "OUT" && !path.is_dir() => command.arg(argument),
            System::Windows => command.arg(windows_path(&path)),
            System::This => command.arg(path),
        };
    }
    run(&mut command).map(|_| out)
}

/// Compiles a program with the library: on Windows the shared one.
pub fn compile(system: System, source: &str, to: &Path) -> Result<()> {
    let windows = system == System::Windows;
    let (compiler, standard) = match (source.ends_with(".cpp"), windows) {
        (true, true) => (CXX, "-std=c++17"),
        (true, false) => ("c++", "-std=c++17"),
        (false, true) => (CC, "-std=c99"),
        (false, false) => ("cc", "-std=c99"),
    };
    let mut command = program(compiler, "-O1 -Wall -Wextra -Werror");
    command.arg(standard).arg("-o").arg(to).arg(root().join(source));
    command.arg("-I").arg(root().join("include")).arg("-I").arg(root().join("examples/c"));
    if windows {
        command.arg(built().join("libpcmvs.dll.a")).arg("-lpthread");
    } else {
        command.arg(target().join("release/libpcmvs.a")).args(["-lm", "-lpthread", "-ldl"]);
    }
    run(&mut command).map(drop)
}
