//! Files on disk that are either complete or missing.

use crate::failure::Failure;
use std::{
    fs::{self, File},
    io::{BufWriter, Write},
    path::{Path, PathBuf},
};

/// Path under which a file is written before it is renamed: hidden, in the same folder.
pub fn temporary(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.tmp"))
}

/// Writes a file under a temporary name and renames it. Creates its folder if necessary.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_parts(path, |put| put(bytes))
}

/// Puts the next bytes of a file.
pub type Put<'a> = &'a mut dyn FnMut(&[u8]) -> Result<(), Failure>;

/// Writes a file part by part under a temporary name, and renames it when all parts are written. Creates its folder if
/// necessary.
pub fn write_parts(path: &Path, parts: impl FnOnce(Put) -> Result<(), Failure>) -> Result<(), Failure> {
    let unwritable = |e| Failure::unwritable(path, &e);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(unwritable)?;
    }
    let temporary = temporary(path);
    let written = File::create(&temporary).map_err(unwritable).and_then(|file| {
        let mut file = BufWriter::new(file);
        parts(&mut |bytes| file.write_all(bytes).map_err(unwritable))?;
        file.flush().map_err(unwritable)?;
        fs::rename(&temporary, path).map_err(unwritable)
    });
    if written.is_err() {
        // Report the error of the write, not one of the clean-up.
        let _ = fs::remove_file(&temporary);
    }
    written
}
