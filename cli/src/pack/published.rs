//! A clip to publish: a folder with the files of several qualities, in segments, and a manifest of version 2 that lists them.

use super::{
    part::{Part, READS, Written},
    source::Source,
};
use crate::{
    arguments::Pack,
    fingerprint::sha256,
    manifest::{FILE_NAME, union},
    output,
    progress::Console,
};
use pcmvs_scene::Failure;
use serde::Serialize;
use serde_json::Value;
use std::{fs, path::Path};

const VERSION: u32 = 2;

/// The manifest of a published clip. `up` and `bounds` are in the frame of the files. Times are in seconds.
#[derive(Serialize)]
struct Published {
    version: u32,
    generator: String,
    units: Option<String>,
    up: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation: Option<[f64; 4]>,
    fps: f64,
    frame_count: usize,
    duration: f64,
    bounds: Option<[[f64; 3]; 2]>,
    /// In the order in which they were given, the best first.
    qualities: Vec<PublishedQuality>,
    #[serde(skip_serializing_if = "Option::is_none")]
    audio: Option<PublishedFile>,
    #[serde(skip_serializing_if = "Option::is_none")]
    poster: Option<PublishedFile>,
}

#[derive(Serialize)]
struct PublishedQuality {
    name: String,
    bytes: u64,
    /// They follow each other without a gap.
    segments: Vec<Segment>,
}

impl PublishedQuality {
    /// Writes the segments of a quality, each of so many frames.
    fn write(name: &str, quality: &Part, length: usize, output: &Path) -> Result<Self, Failure> {
        let mut segments = Vec::new();
        for (i, frames) in quality.frames.chunks(length).enumerate() {
            let number = if length < quality.frames.len() { format!("_{i:03}") } else { String::new() };
            let url = format!("{name}{number}.glb");
            let Written { bytes, sha256 } = Part { frames, ..*quality }.write(&output.join(&url))?;
            segments.push(Segment {
                time: (i * length) as f64 / quality.fps,
                duration: frames.len() as f64 / quality.fps,
                frames: frames.iter().map(|frame| frame.index).collect(),
                file: PublishedFile { url, bytes: bytes.into(), sha256 },
            });
        }
        let bytes = segments.iter().map(|segment| segment.file.bytes).sum();
        Ok(Self { name: name.to_owned(), bytes, segments })
    }
}

/// A file with some frames of the clip, as `pcmvs pack` makes it.
#[derive(Serialize)]
struct Segment {
    time: f64,
    duration: f64,
    /// Numbers of the frames in their capture.
    frames: Vec<u32>,
    #[serde(flatten)]
    file: PublishedFile,
}

/// A file beside the manifest.
#[derive(Serialize)]
struct PublishedFile {
    url: String,
    bytes: u64,
    sha256: String,
}

/// Runs the command for a folder.
pub fn run(options: &Pack, console: &Console) -> Result<(), Failure> {
    let sources = Source::read_all(options)?;
    let chosen = Source::choose(&sources, options.frames.as_ref())?;
    let (output, first) = (options.output.as_path(), &sources[0].manifest);
    check_output(output)?;
    let audio = options.audio.as_deref().map(|path| Extra::read("audio", path)).transpose()?;
    let poster = options.poster.as_deref().map(|path| Extra::read("poster", path)).transpose()?;

    // A manifest must not list files that are being replaced.
    let manifest = output.join(FILE_NAME);
    if manifest.exists() {
        fs::remove_file(&manifest).map_err(|e| Failure::unwritable(&manifest, &e))?;
    }
    let fps = options.fps.unwrap_or(first.fps);
    let count = chosen[0].len();
    let length = options.segment.map_or(count, |seconds| ((seconds * fps).round() as usize).clamp(1, count));
    let bar = console.bar("pack", READS * (count * sources.len()) as u64);
    let mut qualities = Vec::new();
    for (source, frames) in sources.iter().zip(&chosen) {
        let part = Part { folder: source.folder, frames, fps, visibility: options.visibility, console, bar: &bar };
        qualities.push(PublishedQuality::write(source.name, &part, length, output)?);
    }
    drop(bar);
    let published = Published {
        version: VERSION,
        generator: first.generator.clone(),
        units: first.units.clone(),
        up: first.up,
        rotation: first.rotation,
        fps,
        frame_count: count,
        duration: count as f64 / fps,
        // Fewer triangles reach a little farther out.
        bounds: sources.iter().filter_map(|source| source.manifest.bounds).reduce(union),
        qualities,
        audio: audio.map(|audio| audio.write(output)).transpose()?,
        poster: poster.map(|poster| poster.write(output)).transpose()?,
    };
    output::write_json(&manifest, &published)?;
    let megabytes = published.qualities.iter().map(|quality| quality.bytes).sum::<u64>() as f64 / 1e6;
    println!("{count} frames in {} qualities, {megabytes:.1} MB, in {}", sources.len(), output.display());
    Ok(())
}

/// Refuses to write to a folder with another manifest, such as that of the frames themselves.
fn check_output(output: &Path) -> Result<(), Failure> {
    let refused = |path: &Path, what: &str| Err(Failure::Input(format!("{}: {what}", path.display())));
    if output.exists() && !output.is_dir() {
        return refused(output, "is a file: name a folder");
    }
    let manifest = output.join(FILE_NAME);
    if manifest.exists() {
        let bytes = fs::read(&manifest).map_err(|e| Failure::unreadable(&manifest, &e))?;
        let version = serde_json::from_slice::<Value>(&bytes).map(|manifest| manifest["version"].clone());
        if version.ok() != Some(VERSION.into()) {
            return refused(&manifest, "is not that of a published clip: name another folder");
        }
    }
    Ok(())
}

/// A file that is published beside the meshes, under a new name.
struct Extra {
    name: String,
    bytes: Vec<u8>,
}

impl Extra {
    fn read(name: &str, path: &Path) -> Result<Self, Failure> {
        let bytes = fs::read(path).map_err(|e| Failure::unreadable(path, &e))?;
        let extension = path.extension().map(|extension| format!(".{}", extension.to_string_lossy()));
        Ok(Self { name: format!("{name}{}", extension.unwrap_or_default()), bytes })
    }

    fn write(self, folder: &Path) -> Result<PublishedFile, Failure> {
        output::write(&folder.join(&self.name), &self.bytes)?;
        Ok(PublishedFile { url: self.name, bytes: self.bytes.len() as u64, sha256: sha256(&self.bytes) })
    }
}
