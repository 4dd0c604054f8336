//! The result folder: files that are either complete or missing, and the manifest of the clip.

use crate::{
    mesh_file::MeshFile,
    report::{FrameReport, Report},
};
use pcmvs_core::glam::{DQuat, DVec3};
pub use pcmvs_scene::output::{temporary, write};
use pcmvs_scene::{Failure, Scene};
use serde::Serialize;
use std::path::Path;

/// Name of the clip's manifest.
pub const MANIFEST: &str = "sequence.json";
/// Frames per second if the scene does not state it.
const FPS: f64 = 30.0;

/// Writes a value as indented JSON.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let mut bytes = serde_json::to_vec_pretty(value)
        .map_err(|e| Failure::Other(format!("{}: cannot be written ({e})", path.display())))?;
    bytes.push(b'\n');
    write(path, &bytes)
}

/// File name of a frame's mesh.
pub fn frame_name(index: u32, extension: &str) -> String {
    format!("frame_{index:04}.{extension}")
}

/// The manifest that players read. `up` and `bounds` are in the frame of the files.
#[derive(Serialize)]
struct Manifest<'a> {
    version: u32,
    generator: String,
    units: Option<&'a str>,
    up: Option<[f64; 3]>,
    /// Quaternion x, y, z, w that turns the scene's frame to that of the files; left out if they are the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    rotation: Option<[f64; 4]>,
    fps: f64,
    frame_count: usize,
    /// printf pattern that gives the file name of a frame index.
    url: String,
    bounds: Option<[[f64; 3]; 2]>,
    frames: Vec<ManifestFrame<'a>>,
}

#[derive(Serialize)]
struct ManifestFrame<'a> {
    index: u32,
    /// Seconds from the scene's first frame.
    time: f64,
    url: &'a str,
    bytes: u64,
    sha256: &'a str,
}

impl<'a> ManifestFrame<'a> {
    fn new(frame: &'a FrameReport, first_index: u32, fps: f64) -> Self {
        let time = f64::from(frame.index.saturating_sub(first_index)) / fps;
        Self { index: frame.index, time, url: &frame.file, bytes: frame.bytes, sha256: &frame.sha256 }
    }
}

/// Writes the manifest with all frames of the report.
pub fn write_manifest(
    folder: &Path,
    scene: &Scene,
    first_index: u32,
    mesh_file: &MeshFile,
    report: &Report,
) -> Result<(), Failure> {
    let (extension, rotation) = (mesh_file.extension(), mesh_file.rotation());
    let fps = scene.fps.unwrap_or(FPS);
    let manifest = Manifest {
        version: 1,
        generator: format!("pcmvs {}", env!("CARGO_PKG_VERSION")),
        units: scene.units.as_deref(),
        up: mesh_file.up(),
        rotation,
        fps,
        frame_count: report.frames.len(),
        url: format!("frame_%04d.{extension}"),
        bounds: report.frames.iter().map(|frame| turned(frame.bounds, rotation)).reduce(union),
        frames: report.frames.iter().map(|frame| ManifestFrame::new(frame, first_index, fps)).collect(),
    };
    write_json(&folder.join(MANIFEST), &manifest)
}

/// Bounds of a box that is turned by a quaternion.
fn turned(bounds: [[f64; 3]; 2], rotation: Option<[f64; 4]>) -> [[f64; 3]; 2] {
    let Some(rotation) = rotation.map(DQuat::from_array) else { return bounds };
    let corner = |i: usize| rotation * DVec3::from_array([0, 1, 2].map(|axis| bounds[i >> axis & 1][axis]));
    let corners = (0..8).map(|i| corner(i).to_array());
    corners.map(|corner| [corner; 2]).reduce(union).unwrap_or(bounds)
}

fn union(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let of = |end: usize, pick: fn(f64, f64) -> f64| std::array::from_fn(|axis| pick(a[end][axis], b[end][axis]));
    [of(0, f64::min), of(1, f64::max)]
}
