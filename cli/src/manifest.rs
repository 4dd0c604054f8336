//! sequence.json: the manifest of a clip.

use crate::{
    arguments::FPS_RANGE,
    mesh_file::MeshFile,
    output,
    report::{FrameReport, Report},
};
use pcmvs_core::glam::{DQuat, DVec3};
use pcmvs_scene::{Failure, Scene};
use serde::{Deserialize, Serialize};
use std::{fs, path::Path};

/// Name of the file in the result folder.
pub const FILE_NAME: &str = "sequence.json";
const VERSION: u32 = 1;
/// Frames per second if the scene does not state it.
const FPS: f64 = 30.0;

/// The manifest that players read. `up` and `bounds` are in the frame of the files.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Manifest {
    pub version: u32,
    pub generator: String,
    pub units: Option<String>,
    pub up: Option<[f64; 3]>,
    /// Quaternion x, y, z, w that turns the scene's frame to that of the files; left out if they are the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f64; 4]>,
    pub fps: f64,
    pub frame_count: usize,
    /// printf pattern that gives the file name of a frame index.
    pub url: String,
    pub bounds: Option<[[f64; 3]; 2]>,
    /// By index.
    pub frames: Vec<ManifestFrame>,
}

/// A frame of the clip.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct ManifestFrame {
    pub index: u32,
    /// Seconds from the scene's first frame.
    pub time: f64,
    pub url: String,
    pub bytes: u64,
    pub sha256: String,
}

impl ManifestFrame {
    fn new(frame: &FrameReport, first_index: u32, fps: f64) -> Self {
        let time = f64::from(frame.index.saturating_sub(first_index)) / fps;
        Self { index: frame.index, time, url: frame.file.clone(), bytes: frame.bytes, sha256: frame.sha256.clone() }
    }
}

impl Manifest {
    /// The manifest of all frames of a report.
    pub fn new(scene: &Scene, first_index: u32, mesh_file: &MeshFile, report: &Report) -> Self {
        let (extension, rotation) = (mesh_file.extension(), mesh_file.rotation());
        let fps = scene.fps.unwrap_or(FPS);
        Self {
            version: VERSION,
            generator: format!("pcmvs {}", env!("CARGO_PKG_VERSION")),
            units: scene.units.clone(),
            up: mesh_file.up(),
            rotation,
            fps,
            frame_count: report.frames.len(),
            url: format!("frame_%04d.{extension}"),
            bounds: bounds(&report.frames, rotation),
            frames: report.frames.iter().map(|frame| ManifestFrame::new(frame, first_index, fps)).collect(),
        }
    }

    /// Reads the manifest of a result folder.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(FILE_NAME);
        let bytes = fs::read(&path).map_err(|e| Failure::unreadable(&path, &e))?;
        let wrong = |what: String| Failure::Input(format!("{}: {what}", path.display()));
        let manifest: Self = serde_json::from_slice(&bytes)
            .map_err(|e| wrong(format!("is no manifest of a clip ({e}): run `pcmvs reconstruct` again")))?;
        if manifest.version != VERSION {
            let version = manifest.version;
            return Err(wrong(format!(
                "has version {version}, and frames are listed by version {VERSION}: name a folder that `pcmvs reconstruct` made"
            )));
        }
        if !FPS_RANGE.contains(&manifest.fps) {
            let (fps, low, high) = (manifest.fps, FPS_RANGE.start(), FPS_RANGE.end());
            return Err(wrong(format!("`fps` is {fps}, and a clip has {low} to {high}: correct it")));
        }
        manifest
            .frames
            .iter()
            .try_for_each(|frame| output::check_frame_name(&frame.url, frame.index))
            .map_err(wrong)?;
        Ok(manifest)
    }

    /// Whether both are of clips with the same form and frame of reference.
    pub fn is_alike(&self, other: &Self) -> bool {
        let alike = |a: &Self| (a.generator.clone(), a.units.clone(), a.up, a.rotation, a.url.clone());
        alike(self) == alike(other)
    }

    /// Writes the manifest to a result folder.
    pub fn write(&self, folder: &Path) -> Result<(), Failure> {
        output::write_json(&folder.join(FILE_NAME), self)
    }
}

/// Bounds of all frames in the frame of the files.
pub fn bounds(frames: &[FrameReport], rotation: Option<[f64; 4]>) -> Option<[[f64; 3]; 2]> {
    frames.iter().map(|frame| turned(frame.bounds, rotation)).reduce(union)
}

/// Number of gaps that a message names.
const NAMED: usize = 8;

/// Names the frames that are missing between others, as single ones or ranges, if the sorted indices follow each other by
/// their smallest step. `None` if nothing is missing.
pub fn gaps(indices: &[u32]) -> Option<String> {
    let pairs = || indices.windows(2).map(|pair| (pair[0], pair[1]));
    let step = pairs().map(|(a, b)| b.saturating_sub(a)).min().unwrap_or(1);
    let gap = |(a, b): (u32, u32)| {
        let (low, high) = (a.checked_add(step)?, b.checked_sub(step)?);
        (low <= high).then(|| if low == high { low.to_string() } else { format!("{low}..{high}") })
    };
    let gaps: Vec<String> = pairs().filter_map(gap).collect();
    let more = if gaps.len() > NAMED { " and more" } else { "" };
    (!gaps.is_empty()).then(|| format!("{}{more}", gaps[..gaps.len().min(NAMED)].join(",")))
}

/// Bounds of a box that is turned by a quaternion.
fn turned(bounds: [[f64; 3]; 2], rotation: Option<[f64; 4]>) -> [[f64; 3]; 2] {
    let Some(rotation) = rotation.map(DQuat::from_array) else { return bounds };
    let corner = |i: usize| rotation * DVec3::from_array([0, 1, 2].map(|axis| bounds[i >> axis & 1][axis]));
    let corners = (0..8).map(|i| corner(i).to_array());
    corners.map(|corner| [corner; 2]).reduce(union).unwrap_or(bounds)
}

/// The smallest box around two.
pub fn union(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let of = |end: usize, pick: fn(f64, f64) -> f64| std::array::from_fn(|axis| pick(a[end][axis], b[end][axis]));
    [of(0, f64::min), of(1, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_are_missing_between_others_are_named() {
        for whole in [&[3, 4, 5][..], &[0, 10, 20], &[7], &[]] {
            assert_eq!(gaps(whole), None);
        }
        assert_eq!(gaps(&[0, 1, 3, 4, 9]).as_deref(), Some("2,5..8"));
        assert_eq!(gaps(&[0, 5, 15, 30]).as_deref(), Some("10,20..25"));
        let every_second: Vec<u32> = (0..10).map(|i| 3 * i + u32::from(i > 8)).chain([40, 41]).collect();
        assert!(gaps(&every_second).is_some_and(|named| named.ends_with(" and more")));
    }
}
