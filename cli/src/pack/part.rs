//! Frames of a clip that go into one GLB file.
//!
//! The frames' files are read twice, one at a time: first to find out what goes where in the new file, then to copy their bytes.

use super::{
    clip::{Clip, Packed, Piece},
    frame_file::FrameFile,
};
use crate::{
    fingerprint::hex,
    manifest::ManifestFrame,
    output::{self, Put},
    progress::Console,
};
use indicatif::ProgressBar;
use pcmvs_scene::Failure;
use sha2::{Digest, Sha256};
use std::path::Path;

/// Bytes of a GLB's header and those of its two chunks.
const HEADERS: u64 = 12 + 2 * 8;
/// How often a frame's file is read.
pub const READS: u64 = 2;

/// Frames, and how they are shown.
pub struct Part<'a> {
    pub folder: &'a Path,
    pub frames: &'a [&'a ManifestFrame],
    pub fps: f64,
    pub visibility: bool,
    pub console: &'a Console<'a>,
    /// Advances whenever a frame's file is read.
    pub bar: &'a ProgressBar,
}

/// A file that was written.
pub struct Written {
    pub bytes: u32,
    pub sha256: String,
}

impl Part<'_> {
    /// Writes the file.
    pub fn write(&self, output: &Path) -> Result<Written, Failure> {
        let (clip, pieces) = self.join()?;
        let packed = clip.finish(self.fps, self.visibility);
        let bytes = size(&packed).ok_or_else(|| too_large(output, &packed))?;
        let mut hash = Sha256::new();
        output::write_parts(output, |put| {
            self.put(&packed, &pieces, bytes, &mut |bytes| {
                hash.update(bytes);
                put(bytes)
            })
        })?;
        Ok(Written { bytes, sha256: hex(hash.finalize().as_slice()) })
    }

    /// Finds out what goes where, and which bytes come from each frame.
    fn join(&self) -> Result<(Clip, Vec<Vec<Piece>>), Failure> {
        let mut clip = Clip::default();
        let pieces = self.frames.iter().map(|frame| clip.add(format!("frame_{:04}", frame.index), &self.read(frame)?));
        let pieces = pieces.collect::<Result<_, _>>()?;
        Ok((clip, pieces))
    }

    /// Puts the bytes of the file.
    fn put(&self, packed: &Packed, pieces: &[Vec<Piece>], size: u32, put: Put) -> Result<(), Failure> {
        let Packed { json, bytes, binary } = packed;
        put(b"glTF")?;
        put(&2u32.to_le_bytes())?;
        put(&size.to_le_bytes())?;
        put(&(json.len() as u32).to_le_bytes())?;
        put(b"JSON")?;
        put(json)?;
        put(&(*binary as u32).to_le_bytes())?;
        put(b"BIN\0")?;
        let mut end = 0;
        // Bytes start at multiples of four.
        let mut put_at = |place: u64, bytes: &[u8]| {
            put(&[0; 3][..(place - end) as usize])?;
            end = place + bytes.len() as u64;
            put(bytes)
        };
        for (frame, pieces) in self.frames.iter().zip(pieces) {
            let file = self.read(frame)?;
            for piece in pieces {
                put_at(piece.target, file.bytes(piece.source, piece.length)?)?;
            }
        }
        for (place, bytes) in bytes {
            put_at(*place, bytes)?;
        }
        put_at(*binary, &[])
    }

    fn read(&self, frame: &ManifestFrame) -> Result<FrameFile, Failure> {
        if self.console.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        self.bar.inc(1);
        FrameFile::read(self.folder, frame)
    }
}

/// Size of the file, if a GLB can be that large.
fn size(packed: &Packed) -> Option<u32> {
    u32::try_from(HEADERS + packed.json.len() as u64 + packed.binary).ok()
}

fn too_large(output: &Path, packed: &Packed) -> Failure {
    let gib = (packed.json.len() as u64 + packed.binary) as f64 / f64::from(1 << 30);
    Failure::Input(format!(
        "{}: would have {gib:.1} GiB, and a GLB file has at most 4 GiB: pack fewer frames with --frames, or make them smaller by \
         `pcmvs reconstruct` with --faces, --texture and --compress",
        output.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_larger_than_its_header_can_say_is_refused() {
        let packed = |binary| Packed { json: vec![b' '; 100], bytes: Vec::new(), binary };
        let most = (1 << 32) - 4 - HEADERS - 100;
        assert_eq!(size(&packed(most)), Some(u32::MAX - 3));
        assert_eq!(size(&packed(most + 4)), None);
        let message = too_large(Path::new("clip.glb"), &packed(5 << 30)).to_string();
        assert!(message.starts_with("clip.glb: would have 5.0 GiB") && message.contains("--frames"), "{message}");
    }
}
