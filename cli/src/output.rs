//! Files that are either complete or missing.

use pcmvs_scene::Failure;
pub use pcmvs_scene::output::{Put, temporary, write, write_parts};
use serde::Serialize;
use std::path::Path;

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
