//! The npm package, the page, their tests and their figures.

use crate::{
    Result,
    compiler::Compiler,
    process::{cargo, program, root, run, show, target},
    sample,
    setup::{self, Need},
    steps::{Outcome, Steps},
    tables::replace_in,
};
use flate2::{Compression, write::GzEncoder};
use std::{
    fs,
    io::Write,
    panic::resume_unwind,
    path::{Path, PathBuf},
    thread,
};
use wasm_bindgen_cli_support::Bindgen;

/// Maximum size of a build of the package's module, compressed, in bytes.
const MODULE_BUDGET: usize = 716 << 10;
/// Inlines little, which keeps the module within its budget. Hot loops are inlined by attribute.
const INLINE: &str = "-Cllvm-args=-inline-threshold=15";
/// The two builds of the module and their further compiler flags. The page uses the first that the browser can run.
const BUILDS: [(&str, &str); 2] = [("simd", "-Ctarget-feature=+simd128"), ("scalar", "-Ctarget-feature=-simd128")];
/// The browser.
const TRIPLE: &str = "wasm32-unknown-unknown";
/// The files of the package that are written by hand.
const WRITTEN: [&str; 6] = ["index.js", "index.d.ts", "element.d.ts", "player.d.ts", "package.json", "README.md"];
/// The player's files, each a mode of web/vite.player.ts.
const PLAYER: [&str; 2] = ["element", "player"];
/// Maximum size of the player with three.js inside, compressed, in bytes.
const ELEMENT_BUDGET: usize = 240 << 10;

/// Debian's packages that the tests need besides Node.
const TOOLS: [setup::Package; 2] = [setup::CHROMIUM, ("python3", "/usr/bin/python3")];

/// The formatter and linter of JavaScript and TypeScript.
pub const LINTERS: Need = Need::Npm("web");

/// All that the checks need, that of building the page first.
pub const NEEDS: [Need; 5] = [
    Need::TargetOrDebian(TRIPLE),
    Need::Npm("web"),
    Need::Debian(TOOLS[0]),
    Need::Debian(TOOLS[1]),
    Need::Npm("tests/web"),
];

/// Builds the npm package in `wasm/pkg`; returns the sizes of its modules.
pub fn wasm() -> Result<String> {
    let (package, npm) = (root().join("wasm/pkg"), root().join("wasm/npm"));
    fresh(&package)?;
    let compiler = Compiler::install(&[TRIPLE])?;
    // Most of a build is optimisation across crates, which uses one processor: both run at the same time.
    let bound = thread::scope(|scope| {
        let builds = BUILDS.map(|(name, flags)| scope.spawn(move || module(compiler, name, flags)));
        builds.map(|build| build.join().unwrap_or_else(|panic| resume_unwind(panic)))
    });
    let mut glue: Option<String> = None;
    let mut sizes = Vec::new();
    for ((name, _), bound) in BUILDS.into_iter().zip(bound) {
        let bound = bound?;
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
        sizes.push(format!("{name} {} KiB compressed of {} allowed", compressed >> 10, MODULE_BUDGET >> 10));
        if compressed > MODULE_BUDGET {
            return Err(format!("{}: {compressed} bytes compressed of {MODULE_BUDGET} allowed", file.display()));
        }
    }
    WRITTEN.iter().try_for_each(|file| copy(&npm.join(file), &package.join(file)))?;
    sizes.push(player(&package)?);
    Ok(sizes.join(", "))
}

/// Makes one build of the module; returns the folder that has it with its JavaScript.
fn module(compiler: Compiler, name: &str, flags: &str) -> Result<PathBuf> {
    let target = target().join(format!("wasm-{name}"));
    let mut build = compiler.cargo("build --profile wasm --package pcmvs-wasm", TRIPLE, "std,panic_abort")?;
    let flags = [flags, INLINE].join("\u{1f}");
    run(build.env("CARGO_TARGET_DIR", &target).env("CARGO_ENCODED_RUSTFLAGS", flags))?;
    let bound = target.join("bound");
    Bindgen::new()
        .input_path(target.join(TRIPLE).join("wasm/pcmvs_wasm.wasm"))
        .out_name("pcmvs")
        .web(true)
        .and_then(|bindgen| {
            let bindgen = bindgen.typescript(true).omit_default_module_path(true);
            bindgen.remove_name_section(true).remove_producers_section(true).generate(&bound)
        })
        .map_err(|e| format!("wasm-bindgen: {e:#}"))?;
    Ok(bound)
}

/// Builds the player into the npm package; returns its size.
fn player(package: &Path) -> Result<String> {
    let web = root().join("web");
    setup::node_packages(&web)?;
    for mode in PLAYER {
        let mut vite = program(web.join("node_modules/.bin/vite"), "build --logLevel warn --config vite.player.ts");
        run(vite.args(["--mode", mode]).current_dir(&web))?;
    }
    // Its license must come with it, because element.js contains it.
    copy(&web.join("node_modules/three/LICENSE"), &package.join("LICENSE-three"))?;
    let compressed = gzip(&read(&package.join("element.js"))?)?.len();
    if compressed > ELEMENT_BUDGET {
        return Err(format!("element.js: {compressed} bytes compressed of {ELEMENT_BUDGET} allowed"));
    }
    Ok(format!("player {} KiB compressed of {} allowed", compressed >> 10, ELEMENT_BUDGET >> 10))
}

/// Builds the static site in `web/dist`, which works from any folder of any static host; returns its size.
pub fn dist() -> Result<String> {
    let modules = wasm()?;
    sample::make(&root().join("web/public/sample"))?;
    let web = root().join("web");
    setup::node_packages(&web)?;
    run(program("npm", "run build").current_dir(&web))?;
    let dist = web.join("dist");
    let mut paths = Vec::new();
    files(&dist, &mut paths)?;
    let size: u64 = paths.iter().map(|path| fs::metadata(path).map_or(0, |m| m.len())).sum();
    Ok(format!("{modules}; web/dist {} files, {:.1} MB", paths.len(), size as f64 / 1e6))
}

/// Builds the site and serves it on this machine until the program ends.
pub fn demo() -> Result<()> {
    println!("{}", dist()?);
    show(program("npm", "run --silent preview").current_dir(root().join("web")))
}

/// Checks format and lints of all JavaScript and TypeScript in the repository, see biome.json.
pub fn lints() -> Result<()> {
    LINTERS.install()?;
    run(&mut program(root().join("web/node_modules/.bin/biome"), "ci --colors=off --error-on-warnings")).map(drop)
}

/// Builds the site and the command line and drives both, see tests/web; with `long` also what takes minutes.
pub fn check(steps: &mut Steps, long: bool) -> Result<()> {
    steps.step_with(&NEEDS[..2], "page", || dist().map(Outcome::Passed))?;
    if !long {
        // The tests have built a command line, and all builds of it give the same bytes.
        return steps.step_with(&NEEDS, "page in Chromium", || node("test", "debug").map(Outcome::Passed));
    }
    steps.step_with(&NEEDS, "page in Chromium", || {
        release()?;
        node("test", "release").map(Outcome::Passed)
    })?;
    steps.step_with(&NEEDS, "page in Chromium, long", || node("run long", "release").map(Outcome::Passed))
}

/// The checks alone.
pub fn test() -> Result<()> {
    let mut steps = Steps::default();
    steps.announce(&NEEDS);
    check(&mut steps, true)?;
    steps.finish();
    Ok(())
}

/// Measures in the browser and renews its table in BENCHMARKS.md, and README's picture of the page.
pub fn bench() -> Result<()> {
    dist()?;
    release()?;
    let bench = |script: &str| node(script, "release");
    let (table, player) = (bench("run --silent bench")?, bench("run --silent bench-player")?);
    copy(&root().join("tests/web/shots/page.png"), &root().join("docs/page.png"))?;
    replace_in(&root().join("BENCHMARKS.md"), &[("browser", table), ("player", player)])
}

/// Builds the command line and the studio for measurements.
fn release() -> Result<()> {
    run(&mut cargo("build --quiet --release --package pcmvs-cli --package studio --bins")).map(drop)
}

/// Runs a script of the browser tests with the command line and the studio in a folder of the target folder; returns how
/// many tests passed, or what else it printed.
fn node(script: &str, build: &str) -> Result<String> {
    setup::debian(&TOOLS)?;
    let tests = root().join("tests/web");
    setup::node_packages(&tests)?;
    let binary = |name: &str| target().join(build).join(name);
    let mut npm = program("npm", script);
    let printed = run(npm.env("PCMVS", binary("pcmvs")).env("STUDIO", binary("studio")).current_dir(&tests))?;
    let count =
        |word: &str| printed.lines().find_map(|line| line.trim_start_matches(['#', 'ℹ', ' ']).strip_prefix(word));
    Ok(match (count("pass "), count("skipped ")) {
        (Some(passed), Some("0") | None) => format!("{passed} tests"),
        (Some(passed), Some(skipped)) => format!("{passed} tests, {skipped} skipped"),
        (None, _) => printed,
    })
}

/// Paths of all files below a folder.
fn files(folder: &Path, found: &mut Vec<PathBuf>) -> Result<()> {
    let unreadable = |e| format!("{}: {e}", folder.display());
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.is_dir() {
            files(&path, found)?;
        } else {
            found.push(path);
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

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).map(drop).map_err(|e| format!("{} to {}: {e}", from.display(), to.display()))
}

fn gzip(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|e| e.to_string())
}
