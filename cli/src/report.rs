//! report.json: parameters, times and counts of a run, and the fingerprints by which a later run finds finished frames.

use crate::{output, warning::WarningReport};
use pcmvs_core::ViewDiagnostics;
use pcmvs_scene::Failure;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::{fs, path::Path};

/// Name of the file in the result folder.
pub const FILE_NAME: &str = "report.json";

/// The whole report.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Report {
    pub version: String,
    pub preset: String,
    pub masks: String,
    pub cameras: Vec<String>,
    pub threads: usize,
    /// Parameters of the method.
    pub params: Value,
    /// SHA-256 of the program, the parameters and the cameras.
    pub settings: String,
    /// What the correction of the calibration found; null if it was not asked for.
    pub calibration: Option<Value>,
    /// Peak memory of the process so far, in bytes; null if the system does not report it.
    pub peak_memory: Option<u64>,
    /// What may make the results worse although nothing failed: first about the cameras, then by frame.
    pub warnings: Vec<WarningReport>,
    /// Finished frames by index.
    pub frames: Vec<FrameReport>,
    pub failures: Vec<FrameFailure>,
}

impl Report {
    /// Reads the report of a result folder.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(FILE_NAME);
        let bytes = fs::read(&path).map_err(|e| Failure::unreadable(&path, &e))?;
        let report = serde_json::from_slice(&bytes).map_err(|e| e.to_string()).and_then(|report: Self| {
            report.frames.iter().try_for_each(|frame| output::check_frame_name(&frame.file, frame.index))?;
            Ok(report)
        });
        report.map_err(|what| {
            let path = path.display();
            Failure::Input(format!(
                "{path}: is no report of `pcmvs reconstruct` ({what}): run it again for these frames"
            ))
        })
    }
}

/// A finished frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameReport {
    pub index: u32,
    pub file: String,
    pub bytes: u64,
    pub sha256: String,
    /// SHA-256 of the settings and of the pictures and masks of the frame, of its neighbours and of the frames `beyond` them.
    pub fingerprint: String,
    /// Indices of the frames beyond its neighbours that were looked at, because it may have lost a part together with one of
    /// these. It is left out if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub beyond: Vec<u32>,
    /// Smallest and largest coordinates of the mesh.
    pub bounds: [[f64; 3]; 2],
    /// Seconds of every step, in the order in which they ran.
    pub seconds: Map<String, Value>,
    /// Counts of the method's stages.
    pub counts: Value,
    /// How well each camera's view agrees with the others.
    pub cameras: Vec<CameraReport>,
    /// 64-bit hash of every stage's output, in hexadecimal.
    pub hashes: Map<String, Value>,
    /// Peak memory of the process when the frame was done, in bytes.
    pub peak_memory: Option<u64>,
}

/// How well a camera's view agrees with the others in a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CameraReport {
    pub name: String,
    /// Whether the view takes part in the frame.
    pub used: bool,
    /// Intersection over union of the silhouette and the visual hull's picture, 0 to 1; null without a silhouette.
    pub silhouette_overlap: Option<f32>,
    /// Median distance of the hull's outline from the silhouette's contour, in pixels; null without a silhouette.
    pub contour_px: Option<f32>,
    /// Median distance of a few matches from their epipolar lines, in pixels; null if it has not been measured.
    pub epipolar_px: Option<f32>,
}

impl CameraReport {
    pub fn new(name: &str, found: &ViewDiagnostics) -> Self {
        let ViewDiagnostics { used, silhouette_overlap, contour_px, epipolar_px, .. } = *found;
        Self { name: name.to_owned(), used, silhouette_overlap, contour_px, epipolar_px }
    }
}

/// A frame that failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameFailure {
    pub index: u32,
    pub error: String,
}

/// What an earlier run with the same settings finished.
#[derive(Default)]
pub struct Earlier {
    pub frames: Vec<FrameReport>,
    warnings: Vec<WarningReport>,
}

impl Earlier {
    /// Reads the report of an earlier run. It is empty if the report cannot be read, is of another version or of other
    /// settings.
    pub fn read(folder: &Path, settings: &str) -> Self {
        let report = Report::read(folder).ok().filter(|report| report.settings == settings);
        report.map(|report| Self { frames: report.frames, warnings: report.warnings }).unwrap_or_default()
    }

    /// The warnings about a frame.
    pub fn warnings_of(&self, frame: u32) -> impl Iterator<Item = &WarningReport> {
        self.warnings.iter().filter(move |warning| warning.frame == Some(frame))
    }
}

/// Peak resident memory of this process in bytes. Only Linux reports it.
pub fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
