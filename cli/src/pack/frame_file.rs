//! The GLB file of one frame.

use super::document::{Document, Node, Raw};
use crate::{fingerprint::sha256, manifest::ManifestFrame};
use pcmvs_core::glam::{DMat4, DQuat, DVec3};
use pcmvs_scene::Failure;
use serde::de::DeserializeOwned;
use std::{
    fs,
    ops::Range,
    path::{Path, PathBuf},
};

const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// A frame's file in memory.
pub struct FrameFile {
    path: PathBuf,
    bytes: Vec<u8>,
    json: Range<usize>,
    binary: Range<usize>,
}

impl FrameFile {
    /// Reads the file of a frame, and checks that it is the one that the manifest lists.
    pub fn read(folder: &Path, frame: &ManifestFrame) -> Result<Self, Failure> {
        let path = folder.join(&frame.url);
        let bytes = fs::read(&path).map_err(|e| {
            let (path, index) = (path.display(), frame.index);
            Failure::Input(format!("{path}: frame {index} cannot be read ({e}): run `pcmvs reconstruct` again"))
        })?;
        if sha256(&bytes) != frame.sha256 {
            return Err(Failure::Input(format!(
                "{}: frame {} is not the file that sequence.json lists, by its SHA-256: run `pcmvs reconstruct` again",
                path.display(),
                frame.index
            )));
        }
        let Some((json, binary)) = chunks(&bytes) else {
            return Err(damaged(&path, "its chunks are not those of a GLB file"));
        };
        Ok(Self { path, bytes, json, binary })
    }

    /// Its description.
    pub fn document(&self) -> Result<Document, Failure> {
        serde_json::from_slice(&self.bytes[self.json.clone()]).map_err(|e| damaged(&self.path, &e.to_string()))
    }

    /// Bytes of its binary chunk.
    pub fn bytes(&self, offset: u64, length: u64) -> Result<&[u8], Failure> {
        let range = usize::try_from(offset).ok().zip(usize::try_from(length).ok());
        let found = range.and_then(|(offset, length)| self.bytes[self.binary.clone()].get(offset..)?.get(..length));
        found.ok_or_else(|| self.damaged("a buffer view reaches beyond the file's end"))
    }

    /// Its only node, which has the mesh.
    pub fn node<'a>(&self, document: &'a Document) -> Result<&'a Node, Failure> {
        match (document.scenes.as_slice(), document.nodes.as_slice()) {
            ([scene], [node]) if scene.nodes == [0] && node.children.is_empty() => Ok(node),
            _ => Err(self.damaged("it has not one scene with one node")),
        }
    }

    /// The middle of the box around the mesh, by the accessors' stated ranges. It is exact in single precision.
    pub fn middle(&self, document: &Document) -> Result<DVec3, Failure> {
        let node = self.node(document)?;
        let (place, mesh) = (self.place(node)?, self.item(&document.meshes, node.mesh.unwrap_or(u32::MAX))?);
        let mut corners = Vec::new();
        for primitive in &mesh.primitives {
            let positions = primitive.attributes.get("POSITION").copied().unwrap_or(u32::MAX);
            let accessor = self.item(&document.accessors, positions)?;
            let ends: [[f64; 3]; 2] = [self.numbers(accessor.min.as_ref())?, self.numbers(accessor.max.as_ref())?];
            let corner = |i: usize| DVec3::from_array([0, 1, 2].map(|axis| ends[i >> axis & 1][axis]));
            corners.extend((0..8).map(|i| place.transform_point3(corner(i))));
        }
        let (first, rest) = corners.split_first().ok_or_else(|| self.damaged("its mesh is empty"))?;
        let low = rest.iter().fold(*first, |low, &corner| low.min(corner));
        let high = rest.iter().fold(*first, |high, &corner| high.max(corner));
        let middle = ((low + high) / 2.0).as_vec3().as_dvec3();
        if middle.is_finite() { Ok(middle) } else { Err(self.damaged("a coordinate is out of range")) }
    }

    fn place(&self, node: &Node) -> Result<DMat4, Failure> {
        let translation = node.translation.as_ref().map_or(Ok([0.0; 3]), |v| self.numbers(Some(v)))?;
        let rotation = node.rotation.as_ref().map_or(Ok(DQuat::IDENTITY.to_array()), |v| self.numbers(Some(v)))?;
        let scale = node.scale.as_ref().map_or(Ok([1.0; 3]), |v| self.numbers(Some(v)))?;
        Ok(DMat4::from_scale_rotation_translation(scale.into(), DQuat::from_array(rotation), translation.into()))
    }

    fn numbers<T: DeserializeOwned>(&self, value: Option<&Raw>) -> Result<T, Failure> {
        let read = value.and_then(|value| serde_json::from_str(value.get()).ok());
        read.ok_or_else(|| self.damaged("a range or a transformation is missing or has other numbers than expected"))
    }

    /// An item that another one points to.
    pub fn item<'a, T>(&self, items: &'a [T], index: u32) -> Result<&'a T, Failure> {
        items.get(index as usize).ok_or_else(|| self.damaged("an item points to one that does not exist"))
    }

    /// A file that is not as pcmvs writes it.
    pub fn damaged(&self, what: &str) -> Failure {
        damaged(&self.path, what)
    }

    pub fn path(&self) -> &Path {
        &self.path
    }
}

fn damaged(path: &Path, what: &str) -> Failure {
    Failure::Input(format!(
        "{}: is not a GLB file as this version of pcmvs writes it ({what}): run `pcmvs reconstruct` again",
        path.display()
    ))
}

/// The places of the JSON and of the binary data in a GLB file.
fn chunks(bytes: &[u8]) -> Option<(Range<usize>, Range<usize>)> {
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let chunk = |at: usize, kind: &[u8; 4]| {
        let start = at + CHUNK_HEADER;
        let end = start.checked_add(number(at)? as usize)?;
        (bytes.get(at + 4..start)? == kind && end <= bytes.len()).then_some(start..end)
    };
    let is_glb = bytes.starts_with(b"glTF") && number(4)? == 2 && number(8)? as usize == bytes.len();
    let json = is_glb.then(|| chunk(HEADER, b"JSON")).flatten()?;
    let binary = chunk(json.end, b"BIN\0")?;
    Some((json, binary))
}
