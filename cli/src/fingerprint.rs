//! SHA-256 of files, and of all that a result depends on.

use pcmvs_scene::Failure;
use sha2::{Digest, Sha256};
use std::{env, fs, path::Path};

/// SHA-256 in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(Sha256::digest(bytes).as_slice())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256 over a sequence of byte strings. Every one is preceded by its length, so that no two sequences are alike.
#[derive(Clone)]
pub struct Fingerprint(Sha256);

impl Fingerprint {
    /// Starts with the running program: another build may give other results.
    pub fn of_program() -> Result<Self, Failure> {
        let read = |path: &Path| fs::read(path).map_err(|e| Failure::Other(format!("{}: {e}", path.display())));
        let path = env::current_exe().map_err(|e| Failure::Other(format!("the program cannot find itself: {e}")))?;
        let mut fingerprint = Self(Sha256::new());
        fingerprint.add(&read(&path)?);
        Ok(fingerprint)
    }

    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    pub fn finish(self) -> String {
        hex(self.0.finalize().as_slice())
    }
}
