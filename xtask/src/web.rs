//! The npm package, the page, and their tests.

use crate::{
    Result,
    compiler::Compiler,
    process::{cargo, program, root, show, target},
    sample, serve,
};
use flate2::{Compression, write::GzEncoder};
use std::{fs, io::Write, path::Path};
use wasm_bindgen_cli_support::Bindgen;

/// Most that a build of the package's module may weigh, compressed.
const MODULE_BUDGET: usize = 400 << 10;
/// The two builds of the module and their compilers' flags: the page takes the first that runs.
const BUILDS: [(&str, &str); 2] = [("simd", "-Ctarget-feature=+simd128"), ("scalar", "")];
/// The browser.
const TRIPLE: &str = "wasm32-unknown-unknown";
/// What is written by hand in the package.
const WRITTEN: [&str; 4] = ["index.js", "index.d.ts", "package.json", "README.md"];

/// Builds the npm package in `wasm/pkg` and prints its size.
pub fn wasm() -> Result<()> {
    let (package, npm) = (root().join("wasm/pkg"), root().join("wasm/npm"));
    fresh(&package)?;
    let mut glue: Option<String> = None;
    let compiler = Compiler::install(&[TRIPLE])?;
    for (name, flags) in BUILDS {
        let target = target().join(format!("wasm-{name}"));
        let mut build = compiler.cargo("build --profile wasm --package pcmvs-wasm", TRIPLE, "std,panic_abort")?;
        show(build.env("CARGO_TARGET_DIR", &target).env("CARGO_ENCODED_RUSTFLAGS", flags))?;
        let module = target.join(TRIPLE).join("wasm/pcmvs_wasm.wasm");
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
pub fn dist() -> Result<()> {
    wasm()?;
    sample::make(&root().join("web/public/sample"))?;
    let web = root().join("web");
    install(&web)?;
    show(program("npm", "run build").current_dir(&web))?;
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
pub fn demo() -> Result<()> {
    dist()?;
    serve::serve(&root().join("web/dist")).map_err(|e| format!("the page cannot be served: {e}"))
}

/// Builds the site and the command line and drives both: see tests/web.
pub fn test() -> Result<()> {
    dist()?;
    show(&mut cargo("build --release --package pcmvs-cli"))?;
    let tests = root().join("tests/web");
    install(&tests)?;
    show(program("npm", "test").env("PCMVS", target().join("release/pcmvs")).current_dir(&tests))
}

/// Installs what a folder's lock file says, unless that has been done.
pub fn install(folder: &Path) -> Result<()> {
    let (lock, done) = (read(&folder.join("package-lock.json"))?, folder.join("node_modules/.installed-lock"));
    if fs::read(&done).is_ok_and(|installed| installed == lock) {
        return Ok(());
    }
    show(program("npm", "ci --no-audit --no-fund").current_dir(folder))?;
    write(&done, &lock)
}

/// Paths of all files below a folder, relative to `root`, with `/`.
fn files(root: &Path, folder: &Path, found: &mut Vec<String>) -> Result<()> {
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

fn fresh(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))
}

fn read(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn read_text(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).map(drop).map_err(|e| format!("{} to {}: {e}", from.display(), to.display()))
}

fn gzip(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|e| e.to_string())
}
