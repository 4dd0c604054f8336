//! report.json: what was done, how long it took, and what a later run need not do again.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::{fs, path::Path};

/// Name of the file in the folder of results.
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
    /// Most memory the process had so far, bytes; null where the system does not tell.
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
    /// Smallest and largest coordinates.
    pub bounds: [[f32; 3]; 2],
    /// Of every step, in the order in which they ran.
    pub seconds: Map<String, Value>,
    /// Of the method's steps.
    pub counts: Value,
    /// 64-bit hashes of every stage's output, hexadecimal.
    pub hashes: Map<String, Value>,
    /// Most memory the process had when the frame was done, bytes.
    pub peak_memory: Option<u64>,
}

/// A frame that could not be made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FrameFailure {
    pub index: u32,
    pub error: String,
}

/// The finished frames of an earlier run with the same settings. A report that cannot be read, or of another version,
/// counts as none: its frames are made again.
pub fn earlier_frames(folder: &Path, settings: &str) -> Vec<FrameReport> {
    let report = fs::read(folder.join(FILE_NAME)).ok().and_then(|bytes| serde_json::from_slice::<Report>(&bytes).ok());
    report.filter(|report| report.settings == settings).map(|report| report.frames).unwrap_or_default()
}

/// Peak resident memory of this process in bytes, where Linux tells.
pub fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}
