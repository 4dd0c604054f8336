//! report.json: parameters, times and counts of a run, and the fingerprints by which a later run finds finished frames.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::{fs, path::Path};

/// Name of the file in the result folder.
pub const FILE_NAME: &str = "report.json";

/// The whole report.
#[derive(Debug, Serialize, Deserialize)]
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
    /// Peak memory of the process so far, in bytes; null if the system does not report it.
    pub peak_memory: Option<u64>,
    /// Finished frames by index.
    pub frames: Vec<FrameReport>,
    pub failures: Vec<FrameFailure>,
}

/// A finished frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameReport {
    pub index: u32,
    pub file: String,
    pub bytes: u64,
    pub sha256: String,
    /// SHA-256 of the settings and of the frame's pictures and masks.
    pub fingerprint: String,
    /// Smallest and largest coordinates of the mesh.
    pub bounds: [[f32; 3]; 2],
    /// Seconds of every step, in the order in which they ran.
    pub seconds: Map<String, Value>,
    /// Counts of the method's stages.
    pub counts: Value,
    /// 64-bit hash of every stage's output, in hexadecimal.
    pub hashes: Map<String, Value>,
    /// Peak memory of the process when the frame was done, in bytes.
    pub peak_memory: Option<u64>,
}

/// A frame that failed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameFailure {
    pub index: u32,
    pub error: String,
}

/// The finished frames of an earlier run with the same settings. There are none if the report cannot be read or is of
/// another version.
pub fn earlier_frames(folder: &Path, settings: &str) -> Vec<FrameReport> {
    let report = fs::read(folder.join(FILE_NAME)).ok().and_then(|bytes| serde_json::from_slice::<Report>(&bytes).ok());
    report.filter(|report| report.settings == settings).map(|report| report.frames).unwrap_or_default()
}

/// Peak resident memory of this process in bytes. Only Linux reports it.
pub fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
