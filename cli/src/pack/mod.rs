//! `pcmvs pack`: a clip in one GLB file that ordinary players play, or a folder to publish with several qualities of it.

mod binary;
mod chosen;
mod clip;
mod document;
mod flipbook;
mod frame_file;
mod part;
mod published;
mod shared;
mod source;

use crate::{arguments::Pack, manifest::Manifest, progress::Console};
use part::{Part, READS};
use pcmvs_scene::Failure;
use std::{fs::File, io::Read, path::Path, sync::atomic::AtomicBool};

/// Runs the command.
pub fn run(options: &Pack, cancelled: &AtomicBool) -> Result<(), Failure> {
    let console = Console::new(cancelled);
    if options.manifest {
        return published::run(options, &console);
    }
    let (folder, output) = (options.folder.as_path(), options.output.as_path());
    let manifest = Manifest::read(folder)?;
    let frames = chosen::frames(&manifest, options.frames.as_ref(), folder)?;
    check_output(output, &manifest, folder)?;
    let bar = console.bar("pack", READS * frames.len() as u64);
    let (fps, visibility) = (options.fps.unwrap_or(manifest.fps), options.visibility);
    let part = Part { folder, frames: &frames, fps, visibility, console: &console, bar: &bar };
    let written = part.write(output)?;
    drop(bar);
    println!("{} frames, {:.1} MB, in {}", frames.len(), f64::from(written.bytes) / 1e6, output.display());
    Ok(())
}

/// Refuses to replace what is not a GLB file, or a frame of the clip.
fn check_output(output: &Path, manifest: &Manifest, folder: &Path) -> Result<(), Failure> {
    let refused = |what: &str| Err(Failure::Input(format!("{}: {what}", output.display())));
    if output.is_dir() {
        return refused("is a folder: name a file in it, such as clip.glb");
    }
    if output.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("glb")) {
        return refused("is no name of a GLB file: let it end with .glb");
    }
    if !output.exists() {
        return Ok(());
    }
    let mut start = Vec::new();
    let read = File::open(output).and_then(|file| file.take(4).read_to_end(&mut start));
    read.map_err(|e| Failure::unreadable(output, &e))?;
    if start != b"glTF" {
        return refused("exists already and is no GLB file: name another file or remove that one");
    }
    let canonical = |path: &Path| path.canonicalize().map_err(|e| Failure::unreadable(path, &e));
    let (output, folder) = (canonical(output)?, canonical(folder)?);
    if manifest.frames.iter().any(|frame| folder.join(&frame.url) == output) {
        return refused("is a frame of the clip: name another file");
    }
    Ok(())
}
