//! Access to the files of a capture.

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// A tree of files that can be read.
pub trait Files {
    /// The bytes of a file.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
    /// Whether the path is a file.
    fn is_file(&self, path: &Path) -> bool;
    /// Whether the path is a folder.
    fn is_folder(&self, path: &Path) -> bool;
    /// Paths of the files and folders in a folder, sorted by name, without the companions `._NAME` that macOS writes on other
    /// systems' disks.
    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>>;
}

/// The file system.
#[derive(Debug, Clone, Copy)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        fs::read(path)
    }

    fn is_file(&self, path: &Path) -> bool {
        path.is_file()
    }

    fn is_folder(&self, path: &Path) -> bool {
        path.is_dir()
    }

    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        let mut paths: Vec<PathBuf> =
            fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
        paths.retain(|path| !path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("._")));
        paths.sort();
        Ok(paths)
    }
}
