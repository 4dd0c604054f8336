//! `cargo xtask demo`: renders a capture, reconstructs it and serves the page.

use crate::{
    Result,
    process::{cargo, program, root, show, target},
    web,
};
use std::time::Instant;

/// Makes out/sample, out/demo and out/demo/look.png unless they exist, and serves the page unless `no_serve`.
pub fn run(no_serve: bool) -> Result<()> {
    println!("Building pcmvs and the studio ...");
    show(&mut cargo("build --quiet --release --package pcmvs-cli --package studio --bins"))?;
    let start = Instant::now();
    let binary = |name: &str| target().join("release").join(name);
    if root().join("out/sample/scene.json").exists() {
        println!("The sample capture exists in out/sample.");
    } else {
        println!("Rendering the sample capture: a figure, 20 cameras, 12 frames ...");
        show(&mut program(binary("studio"), "--output out/sample --sample"))?;
    }
    println!("Reconstructing ...");
    show(&mut program(binary("pcmvs"), "reconstruct out/sample -o out/demo"))?;
    show(&mut program(binary("look"), "out/sample out/demo/frame_0000.glb -o out/demo/look.png"))?;
    println!("{:.0} s, without the build. Results in out/demo:", start.elapsed().as_secs_f64());
    println!("  look.png          photograph, shape and colours of the first frame, from three cameras");
    println!(
        "  frame_FFFF.glb    one closed, coloured mesh per frame: open it in Blender (File, Import, glTF), or drop it"
    );
    println!("                    on any glTF viewer's page; up is +z, most viewers take it for +y");
    println!("  sequence.json     the clip's manifest, for players");
    println!("  report.json       seconds, counts and hashes of every stage");
    if no_serve {
        return Ok(());
    }
    println!("Building the page, which reconstructs the sample in the browser ...");
    web::demo()
}
