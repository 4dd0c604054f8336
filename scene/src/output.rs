//! Files on disk that are either complete or missing.

use crate::failure::Failure;
use std::{
    fs,
    path::{Path, PathBuf},
};

/// Path under which a file is written before it is renamed: hidden, in the same folder.
pub fn temporary(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.tmp"))
}

/// Writes a file under a temporary name and renames it. Creates its folder if necessary.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let unwritable = |e| Failure::unwritable(path, &e);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(unwritable)?;
    }
    let temporary = temporary(path);
    let written = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    written.map_err(|e| {
        // Report the error of the write, not one of the clean-up.
        let _ = fs::remove_file(&temporary);
        unwritable(e)
    })
}
