//! Folders on disk, for commands that read and write there.

use std::{fs, path::PathBuf};
use tempfile::TempDir;

/// A folder that is removed at the end.
pub struct Folder(TempDir);

impl Folder {
    /// An empty folder.
    #[expect(clippy::new_without_default, reason = "it makes a folder on disk")]
    pub fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder can be made"))
    }

    /// The path of a file or folder in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Fails if there is something in it that has none of these names.
    pub fn assert_contains_only(&self, names: &[&str]) {
        for entry in fs::read_dir(self.0.path()).expect("the folder is there") {
            let name = entry.expect("the folder can be listed").file_name();
            assert!(names.iter().any(|&known| name == known), "{name:?} was written");
        }
    }
}
