//! The npm package, the page, their tests and their figures.

use crate::{
    Result,
    compiler::Compiler,
    process::{cargo, program, root, run, show, target},
    sample,
    setup::{self, Need},
    shared_memory,
    steps::{Outcome, Steps},
    tables::replace_in,
    wasm_module::{INLINE, SMALL, TRIPLE, bind, copy, gzip, places, read},
};
use std::{
    fs,
    panic::resume_unwind,
    path::{Path, PathBuf},
    thread,
};

/// A module of the package.
struct Module {
    /// The feature of pcmvs-wasm that is this module.
    feature: &'static str,
    /// Name of its files in the package.
    file: &'static str,
    /// Maximum size of a build, compressed, in bytes.
    budget: usize,
    /// Whether it has a build with 128-bit instructions, too. Reading a calibration takes no time.
    has_simd: bool,
}

/// Each is loaded when it is needed, and has its own memory.
const MODULES: [Module; 4] = [
    Module { feature: "reconstruction", file: "pcmvs", budget: 404 << 10, has_simd: true },
    Module { feature: "calibration", file: "pcmvs-calibration", budget: 290 << 10, has_simd: true },
    Module { feature: "forms", file: "pcmvs-forms", budget: 330 << 10, has_simd: true },
    Module { feature: "scene", file: "pcmvs-scene", budget: 280 << 10, has_simd: false },
];
/// The builds of a module and their further compiler flags. The page uses the first that the browser can run.
const BUILDS: [(&str, &str); 2] = [(SIMD, "-Ctarget-feature=+simd128"), ("scalar", "-Ctarget-feature=-simd128")];
const SIMD: &str = "simd";
/// The files of the package that are written by hand.
const WRITTEN: [&str; 16] = [
    "index.js",
    "index.d.ts",
    "calibration.js",
    "calibration.d.ts",
    "forms.js",
    "forms.d.ts",
    "scene.js",
    "scene.d.ts",
    "threads.js",
    "threads.d.ts",
    "thread.js",
    "load.js",
    "element.d.ts",
    "player.d.ts",
    "package.json",
    "README.md",
];
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

/// Builds the npm package in `wasm/pkg`; returns the sizes of its modules and of the player.
pub fn wasm() -> Result<String> {
    let (package, npm) = (root().join("wasm/pkg"), root().join("wasm/npm"));
    fresh(&package)?;
    let compiler = Compiler::install(&[TRIPLE])?;
    // Most of a build is optimisation across crates, which uses one processor: both run at the same time.
    let bound = thread::scope(|scope| {
        let builds = BUILDS.map(|(name, flags)| scope.spawn(move || modules(compiler, name, flags)));
        builds.map(|build| build.join().unwrap_or_else(|panic| resume_unwind(panic)))
    });
    let [simd, scalar] = bound;
    let (simd, scalar) = (simd?, scalar?);
    let mut sizes = Vec::new();
    for module in &MODULES {
        sizes.push(module.add(&package, &simd, &scalar)?);
    }
    sizes.push(shared_memory::add(compiler, &package)?);
    WRITTEN.iter().try_for_each(|file| copy(&npm.join(file), &package.join(file)))?;
    sizes.push(player(&package)?);
    Ok(sizes.join(", "))
}

impl Module {
    /// Copies its builds and their JavaScript from the builds' folders into the package; returns its size.
    fn add(&self, package: &Path, simd: &Path, scalar: &Path) -> Result<String> {
        let Self { feature, file, budget, has_simd } = *self;
        let script = format!("{file}.js");
        if has_simd && read(&simd.join(&script))? != read(&scalar.join(&script))? {
            return Err(format!("the builds of {feature} need different JavaScript: the package ships one for both"));
        }
        for file in [script, format!("{file}.d.ts")] {
            copy(&scalar.join(&file), &package.join(&file))?;
        }
        let mut largest = 0;
        for (folder, build) in [(scalar, "scalar"), (simd, SIMD)] {
            if build == SIMD && !has_simd {
                continue;
            }
            let wasm = package.join(format!("{file}.{build}.wasm"));
            copy(&folder.join(format!("{file}_bg.wasm")), &wasm)?;
            let compressed = gzip(&read(&wasm)?)?.len();
            if compressed > budget {
                return Err(format!("{}: {compressed} bytes compressed of {budget} allowed", wasm.display()));
            }
            largest = largest.max(compressed);
        }
        Ok(format!("{feature} {} KiB compressed of {} allowed", largest >> 10, budget >> 10))
    }
}

/// Makes one build of all modules that have it; returns the folder that has them with their JavaScript.
fn modules(compiler: Compiler, name: &str, flags: &str) -> Result<PathBuf> {
    let target = target().join(format!("wasm-{name}"));
    let bound = target.join("bound");
    let places = places()?.join("\u{1f}");
    for Module { feature, file, .. } in MODULES.iter().filter(|module| module.has_simd || name != SIMD) {
        let arguments = format!("rustc --profile wasm --package pcmvs-wasm --no-default-features --features {feature}");
        let mut build = compiler.cargo(&arguments, TRIPLE, "std,panic_abort")?;
        let flags = [flags, INLINE, &places].join("\u{1f}");
        build.arg("--").args(SMALL);
        run(build.env("CARGO_TARGET_DIR", &target).env("CARGO_ENCODED_RUSTFLAGS", flags))?;
        bind(&target, &bound, file)?;
    }
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
    steps.step_with(&[Need::LibrarySource], "module with threads", || Ok(shared_memory::prepare()))?;
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
