//! SHA-256 of files, and of everything that a result depends on.

use pcmvs_scene::Failure;
use sha2::{Digest, Sha256};
use std::{env, fs, path::Path};

/// SHA-256 in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    hex(Sha256::digest(bytes).as_slice())
}

/// Bytes in hexadecimal.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// SHA-256 over a sequence of byte strings. The length of each is hashed first, so that different sequences give different
/// input to the hash.
#[derive(Clone, Default)]
pub struct Fingerprint(Sha256);

impl Fingerprint {
    /// Starts with the bytes of the running program, because another build may give other results.
    pub fn of_program() -> Result<Self, Failure> {
        let read = |path: &Path| fs::read(path).map_err(|e| Failure::Other(format!("{}: {e}", path.display())));
        let path = env::current_exe()
            .map_err(|e| Failure::Other(format!("the path of the running program cannot be found ({e})")))?;
        let mut fingerprint = Self::default();
        fingerprint.add(&read(&path)?);
        Ok(fingerprint)
    }

    pub fn add(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// Adds whether there are bytes, and then the bytes.
    pub fn add_optional(&mut self, bytes: Option<&[u8]>) {
        self.add(&[u8::from(bytes.is_some())]);
        self.add(bytes.unwrap_or_default());
    }

    pub fn finish(self) -> String {
        hex(self.0.finalize().as_slice())
    }
}
