//! Set-up and checks. `cargo xtask --help` lists the tasks.

mod abi;
mod abi_check;
mod bench;
mod blender;
mod browser;
mod captured;
mod compiler;
mod cycles;
mod demo;
mod farm;
mod faults;
mod forms;
mod fuzz;
mod golden;
mod instructions;
mod measure;
mod miri;
mod no_std;
mod oldest_compiler;
mod players;
mod process;
mod publish;
mod python;
mod result;
mod sample;
mod setup;
mod shared_memory;
mod speed;
mod steps;
mod supply;
mod tables;
mod take;
mod test;
mod wasm_module;
mod web;
mod windows;

pub use result::Result;

use clap::{Parser, Subcommand};
use std::process::ExitCode;
use steps::Steps;

#[derive(Debug, Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Render and reconstruct a sample capture into out/demo, then build and serve the page that does the same
    Demo {
        /// Do not build and serve the page
        #[arg(long)]
        no_serve: bool,
    },
    /// Make all checks, after printing what is missing on this machine and will be installed
    Test {
        /// Include the long checks of the C library, which install compilers and tools, and those of the captured scenes.
        /// PCMVS_DATA names the folder of the scenes, PCMVS_SCORE the tool that scores them
        #[arg(long)]
        all: bool,
        /// Install nothing, and skip the checks that need something missing
        #[arg(long)]
        no_install: bool,
    },
    /// Check that all builds give the golden results, on all machines that are available or can be emulated
    Golden {
        /// Write a new tests/golden/golden.txt instead, for a change that is meant to change results
        #[arg(long)]
        renew: bool,
        /// Compare one build only, by its name in the list of checks, such as Windows
        #[arg(long, conflicts_with = "renew")]
        build: Option<String>,
    },
    /// Check that no crate has an import cycle between its modules
    Cycles,
    /// Build the page and serve it on this machine
    Web {
        /// Only build the static site, in web/dist
        #[arg(long)]
        dist: bool,
        /// Build it and test it in Chromium, which is installed if it is missing
        #[arg(long, conflicts_with = "dist")]
        test: bool,
        /// Build it, measure in Chromium, and renew the tables of browser and player in BENCHMARKS.md
        #[arg(long, conflicts_with_all = ["dist", "test"])]
        bench: bool,
    },
    /// Play a clip in three.js, Babylon.js and model-viewer, and compare with our own pictures of it
    Players,
    /// Import a clip into Blender, of which a Python package is installed
    Blender,
    /// Make a clip on a Slurm cluster on this machine, of which a node is killed in the middle
    Farm,
    /// Build the npm package in wasm/pkg
    Wasm,
    /// Build the C library, and install it with headers, pkg-config file and CMake package
    Install {
        /// Folder in which include and lib are created. It can be moved afterwards
        #[arg(long, required_unless_present = "check")]
        prefix: Option<std::path::PathBuf>,
        /// For another system than this one, such as x86_64-pc-windows-gnu
        #[arg(long)]
        target: Option<String>,
        /// Make the long checks of the C library instead, which install compilers and tools
        #[arg(long)]
        check: bool,
    },
    /// Build the wheel of the Python package and test it in a virtual environment in the target folder
    Python,
    /// Build for Windows and check under Wine that files are the same, byte for byte
    Windows,
    /// Run tests under Miri, on a nightly compiler
    Miri,
    /// Check licences, sources and known vulnerabilities of all dependencies
    Supply,
    /// Run the fuzz targets of tests/fuzz on a nightly compiler
    Fuzz {
        /// Seconds of each target
        #[arg(long, default_value_t = 60)]
        seconds: u32,
        /// One target only: scene, import, clip, picture, calls or reconstruct
        #[arg(long)]
        target: Option<String>,
    },
    /// Generate include/pcmvs.h from the sources
    Header,
    /// Measure on the captured scenes and renew the tables of BENCHMARKS.md
    Bench {
        /// Use one scene only, and print the tables
        #[arg(long)]
        quick: bool,
        /// Renew one table only: scores, ablations-default, faults, configurations, ablations-paper,
        /// scaling, threads, meshing, instructions or wasm
        #[arg(long)]
        part: Option<String>,
    },
}

fn main() -> ExitCode {
    let task = Arguments::parse().task;
    if matches!(task, Task::Demo { no_serve: false } | Task::Web { .. } | Task::Wasm) {
        // The package says if it has to go without.
        drop(shared_memory::prepare());
    }
    let result = match task {
        Task::Demo { no_serve } => demo::run(no_serve),
        Task::Test { all, no_install } => test::run(all, !no_install),
        Task::Golden { renew: true, .. } => golden::renew(),
        Task::Golden { build, .. } => golden::run_alone(build.as_deref()),
        Task::Cycles => cycles::check().map(|counted| println!("{counted}")),
        Task::Web { dist: true, .. } => web::dist().map(|sizes| println!("{sizes}")),
        Task::Web { test: true, .. } => web::test(),
        Task::Web { bench: true, .. } => web::bench(),
        Task::Web { .. } => web::demo(),
        Task::Players => players::run_alone(),
        Task::Blender => blender::run_alone(),
        Task::Farm => farm::test(),
        Task::Wasm => web::wasm().map(|sizes| println!("{sizes}")),
        Task::Install { prefix: Some(prefix), target, check: false } => abi::install(&prefix, target.as_deref()),
        Task::Install { .. } => test::c_library(),
        Task::Python => python::test(),
        Task::Windows => windows::test(),
        Task::Miri => Steps::alone(&miri::NEEDS, |steps| steps.step_with(&miri::NEEDS, "Miri", miri::check)),
        Task::Supply => Steps::alone(&supply::NEEDS, supply::check),
        Task::Fuzz { seconds, target } => fuzz::run(seconds, target.as_deref()),
        Task::Header => abi::header(),
        Task::Bench { quick, part } => bench::run(quick, part.as_deref()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}
