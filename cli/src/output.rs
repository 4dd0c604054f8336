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

/// Refuses a name that a report or a manifest lists for a frame unless it is that of the frame's mesh. Another name could lead
/// out of the folder.
pub fn check_frame_name(name: &str, index: u32) -> Result<(), String> {
    let extension = name.strip_prefix(&frame_name(index, "")).unwrap_or_default();
    let is_extension = !extension.is_empty() && extension.bytes().all(|byte| byte.is_ascii_alphanumeric());
    let expected = frame_name(index, "glb");
    if is_extension {
        Ok(())
    } else {
        Err(format!("lists {name:?} as the file of frame {index} instead of {expected}"))
    }
}
