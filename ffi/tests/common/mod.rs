//! A small capture, and programs in C and C++ built against the library under test.
#![allow(dead_code, reason = "each test uses a part")]

pub mod plain;

use std::{
    env,
    ffi::OsStr,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Output},
};
use studio::Capture;
use tempfile::TempDir;

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Where cargo has put the libraries under test.
pub fn libraries() -> PathBuf {
    env::current_exe().unwrap().parent().unwrap().to_owned()
}

/// Name by which programs load the shared library.
pub fn soname() -> String {
    format!("libpcmvs.so.{}.{}", env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"))
}

/// Whether a program is installed. If it is not, the test skips the checks that need it, and this prints so. With
/// `PCMVS_ALL_TOOLS=1`, which `cargo xtask test --all` sets, a missing program is a failure.
pub fn has(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok_and(|o| o.status.success());
    if !found {
        missing(program);
    }
    found
}

/// Whether `cargo xtask test --all` runs the tests. It allows them to take long.
pub fn thorough() -> bool {
    env::var_os("PCMVS_ALL_TOOLS").is_some()
}

/// Reports that a test skips the checks that need a tool.
pub fn missing(tool: &str) {
    assert!(!thorough(), "{tool} is not installed");
    let test = std::thread::current().name().unwrap_or("a test").to_owned();
    // `println!` would be shown only if the test fails.
    let line = format!("SKIPPED: {test}: {tool} is not installed\n");
    std::io::stdout().write_all(line.as_bytes()).unwrap();
}

/// Runs a command that must succeed.
pub fn run(command: &mut Command) -> Output {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(
        output.status.success(),
        "{command:?}: {}\n{}\n{}",
        output.status,
        text(&output.stdout),
        text(&output.stderr)
    );
    output
}

/// How a program is linked.
#[derive(Clone, Copy, PartialEq)]
pub enum Link {
    Shared,
    Static,
}

pub const C99: &[&str] = &["cc", "-std=c99"];
pub const CPP17: &[&str] = &["c++", "-std=c++17", "-pthread"];

/// Builds a program in a folder. Warnings are errors.
pub fn build(folder: &Path, compiler: &[&str], source: &str, link: Link) -> PathBuf {
    let source = root().join(source);
    let program = folder.join(source.file_stem().unwrap());
    let mut command = Command::new(compiler[0]);
    command.args(&compiler[1..]).args(["-O1", "-g", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]);
    command.arg("-I").arg(root().join("include")).arg("-I").arg(root().join("examples/c")).arg("-I").arg(folder);
    command.arg(&source).arg("-o").arg(&program);
    match link {
        Link::Shared => {
            let shared = folder.join(soname());
            if !shared.exists() {
                std::os::unix::fs::symlink(libraries().join("libpcmvs.so"), &shared).unwrap();
            }
            command.arg(&shared).arg(format!("-Wl,-rpath,{}", folder.display()));
        }
        Link::Static => {
            command.arg(libraries().join("libpcmvs.a")).args(["-lpthread", "-ldl", "-lm"]);
        }
    }
    run(&mut command);
    program
}

/// Builds the parts of meshoptimizer that compress, of the source that the command line has, in a folder. Returns what a
/// compiler needs to use them.
pub fn meshoptimizer(folder: &Path) -> [String; 4] {
    let mut metadata = Command::new(env!("CARGO"));
    metadata.args(["metadata", "--format-version", "1", "--offline", "--manifest-path"]);
    let printed = run(metadata.arg(root().join("ffi/Cargo.toml"))).stdout;
    let metadata: serde_json::Value = serde_json::from_slice(&printed).unwrap();
    let package = metadata["packages"].as_array().unwrap().iter().find(|package| package["name"] == "meshopt").unwrap();
    let manifest = Path::new(package["manifest_path"].as_str().unwrap());
    let source = manifest.parent().unwrap().join("vendor/src");
    let library = folder.join("libmeshoptimizer.so");
    let mut command = Command::new("c++");
    command.args(["-std=c++11", "-O2", "-DNDEBUG", "-shared", "-fPIC", "-o"]).arg(&library);
    for part in ["allocator", "indexcodec", "stripifier", "vcacheoptimizer", "vertexcodec", "vfetchoptimizer"] {
        command.arg(source.join(part).with_extension("cpp"));
    }
    run(&mut command);
    let header = source.display().to_string();
    // The header of another project may cause warnings.
    ["-isystem".to_owned(), header, "-Wl,--no-as-needed".to_owned(), library.display().to_string()]
}

/// Output of a program that must succeed.
pub fn output<A: AsRef<OsStr>>(program: &Path, arguments: impl IntoIterator<Item = A>) -> String {
    String::from_utf8(run(Command::new(program).args(arguments)).stdout).unwrap()
}

/// A capture in two forms: a scene for the command line, and plain files for the examples in C.
pub struct Sample {
    pub folder: TempDir,
}

impl Sample {
    pub fn new() -> Self {
        Self::sized(10, 160, 120)
    }

    pub fn sized(views: u32, width: u32, height: u32) -> Self {
        Self::of(&plain::capture(views, width, height))
    }

    /// A capture of which camera 4 was turned after it was calibrated.
    pub fn turned() -> Self {
        Self::of(&plain::one_turned())
    }

    /// A capture of a moving figure. `plain` has its first frame, and `plainN` the frame N.
    pub fn take(frames: u32) -> Self {
        Self::of(&plain::take(frames))
    }

    /// Three frames of a moving figure. All masks of the second one lack the upper third of the figure.
    pub fn lacking() -> Self {
        Self::of(&plain::lacking())
    }

    fn of(capture: &Capture) -> Self {
        let folder = tempfile::tempdir().unwrap();
        capture.write(&folder.path().join("scene")).unwrap();
        plain::write(capture, 0, &folder.path().join("plain")).unwrap();
        for frame in 1..capture.frames.len() {
            plain::write(capture, frame, &folder.path().join(format!("plain{frame}"))).unwrap();
        }
        Self { folder }
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    pub fn plain(&self) -> PathBuf {
        self.path().join("plain")
    }
}
