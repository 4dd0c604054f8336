//! The npm package, the page, and their tests.

use crate::{sample, serve};
use flate2::{Compression, write::GzEncoder};
use std::{
    env, fs,
    io::Write,
    path::{Path, PathBuf},
    process::Command,
};
use wasm_bindgen_cli_support::Bindgen;

/// Most that a build of the package's module may weigh, compressed.
const MODULE_BUDGET: usize = 400 << 10;
/// The two builds of the module and their compilers' flags: the page takes the first that runs.
const BUILDS: [(&str, &str); 2] = [("simd", "-Ctarget-feature=+simd128"), ("scalar", "")];
/// What is written by hand in the package.
const WRITTEN: [&str; 4] = ["index.js", "index.d.ts", "package.json", "README.md"];

type Outcome<T = ()> = Result<T, String>;

/// Builds the npm package in `wasm/pkg` and prints its size.
pub fn wasm() -> Outcome {
    let (package, npm) = (root().join("wasm/pkg"), root().join("wasm/npm"));
    fresh(&package)?;
    let mut glue: Option<String> = None;
    for (name, flags) in BUILDS {
        let target = target().join(format!("wasm-{name}"));
        run(Command::new(env!("CARGO"))
            .args([
                "build",
                "--profile",
                "wasm",
                "-p",
                "pcmvs-wasm",
                "--target",
                "wasm32-unknown-unknown",
                "--target-dir",
            ])
            .arg(&target)
            .env("CARGO_ENCODED_RUSTFLAGS", flags)
            .current_dir(root()))?;
        let module = target.join("wasm32-unknown-unknown/wasm/pcmvs_wasm.wasm");
        let bound = target.join("bound");
        Bindgen::new()
            .input_path(module)
            .out_name("pcmvs")
            .web(true)
            .and_then(|bindgen| {
                let bindgen = bindgen.typescript(true).omit_default_module_path(true);
                bindgen.remove_name_section(true).remove_producers_section(true).generate(&bound)
            })
            .map_err(|e| format!("wasm-bindgen: {e:#}"))?;
        let code = read_text(&bound.join("pcmvs.js"))?;
        if *glue.get_or_insert_with(|| code.clone()) != code {
            return Err(String::from("the builds need different JavaScript: the package ships one for both"));
        }
        for file in ["pcmvs.js", "pcmvs.d.ts"] {
            copy(&bound.join(file), &package.join(file))?;
        }
        let file = package.join(format!("pcmvs.{name}.wasm"));
        copy(&bound.join("pcmvs_bg.wasm"), &file)?;
        let bytes = read(&file)?;
        let compressed = gzip(&bytes)?.len();
        println!("pcmvs.{name}.wasm: {} KiB, {} KiB compressed", bytes.len() >> 10, compressed >> 10);
        if compressed > MODULE_BUDGET {
            return Err(format!("{}: more than {} KiB compressed", file.display(), MODULE_BUDGET >> 10));
        }
    }
    WRITTEN.iter().try_for_each(|file| copy(&npm.join(file), &package.join(file)))
}

/// Builds the static site in `web/dist`: it works from any folder of any static host.
pub fn dist() -> Outcome {
    wasm()?;
    sample::make(&root().join("web/public/sample"))?;
    let web = root().join("web");
    install(&web)?;
    run(Command::new("npm").args(["run", "build"]).current_dir(&web))?;
    // What the service worker keeps for use without a network.
    let dist = web.join("dist");
    let mut paths = Vec::new();
    files(&dist, &dist, &mut paths)?;
    paths.sort();
    let list: Vec<String> = paths.iter().map(|path| format!("{path:?}")).collect();
    write(&dist.join("files.json"), format!("[{}]\n", list.join(",")).as_bytes())?;
    let size: u64 = paths.iter().map(|path| fs::metadata(dist.join(path)).map_or(0, |m| m.len())).sum();
    println!("web/dist: {} files, {:.1} MB", paths.len(), size as f64 / 1e6);
    Ok(())
}

/// Builds the site and serves it on this machine until the program ends.
pub fn demo() -> Outcome {
    dist()?;
    serve::serve(&root().join("web/dist")).map_err(|e| format!("the page cannot be served: {e}"))
}

/// Builds the site and the command line and drives both: see tests/web.
pub fn test() -> Outcome {
    dist()?;
    run(Command::new(env!("CARGO"))
        .args(["build", "--release", "-p", "pcmvs-cli", "--target-dir"])
        .arg(target())
        .current_dir(root()))?;
    let tests = root().join("tests/web");
    install(&tests)?;
    run(Command::new("npm").arg("test").env("PCMVS", target().join("release/pcmvs")).current_dir(&tests))
}

/// Installs what a folder's lock file says, unless that has been done.
fn install(folder: &Path) -> Outcome {
    let (lock, done) = (read(&folder.join("package-lock.json"))?, folder.join("node_modules/.installed-lock"));
    if fs::read(&done).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    run(Command::new("npm").args(["ci", "--no-audit", "--no-fund"]).current_dir(folder))?;
    write(&done, &lock)
}

/// Paths of all files below a folder, relative to `root`, with `/`.
fn files(root: &Path, folder: &Path, found: &mut Vec<String>) -> Outcome {
    let unreadable = |e| format!("{}: {e}", folder.display());
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.is_dir() {
            files(root, &path, found)?;
        } else if let Ok(relative) = path.strip_prefix(root) {
            found.push(relative.to_string_lossy().replace('\\', "/"));
        }
    }
    Ok(())
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn target() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

fn run(command: &mut Command) -> Outcome {
    let status = command.status().map_err(|e| format!("{command:?}: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("{command:?}: {status}")) }
}

fn fresh(folder: &Path) -> Outcome {
    if folder.exists() {
        fs::remove_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))
}

fn read(path: &Path) -> Outcome<Vec<u8>> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn read_text(path: &Path) -> Outcome<String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn write(path: &Path, bytes: &[u8]) -> Outcome {
    fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}

fn copy(from: &Path, to: &Path) -> Outcome {
    fs::copy(from, to).map(drop).map_err(|e| format!("{} to {}: {e}", from.display(), to.display()))
}

fn gzip(bytes: &[u8]) -> Outcome<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|e| e.to_string())
}
