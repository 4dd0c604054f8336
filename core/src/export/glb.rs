//! Binary glTF 2.0 (GLB) with one unlit mesh with vertex colours.

use super::{Frame, local_bounds, put};
use crate::point_cloud::Mesh;
use alloc::{format, string::String, vec::Vec};
use core::fmt::Write;
use glam::{DVec3, Vec3};

/// Optional content of a GLB, besides positions, colours and triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Whether to write normals. The unlit material does not need them, but hosts that light the mesh do.
    pub normals: bool,
    /// The scene's upward direction, written as `scenes[0].extras.up`. In glTF up is +y, but the coordinates remain in
    /// the scene's frame. Players turn the scene if its upward direction differs.
    pub up: Option<[f64; 3]>,
}

impl Default for Options {
    fn default() -> Self {
        Self { normals: true, up: None }
    }
}

const JSON_CHUNK: u32 = 0x4E4F_534A;
const BIN_CHUNK: u32 = 0x004E_4942;
const FLOAT: u32 = 5126;
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;

/// Writes a mesh as the bytes of a GLB file.
///
/// Positions are in the scene's frame (`origin` is [`crate::Rig::origin`]). Those of an object far from the scene's origin
/// are relative to the translation of the mesh's node. Colours are linear and in single precision.
/// Indices have 16 bits if that is sufficient. A mesh without triangles gives a valid file without a scene.
pub fn write(mesh: &Mesh, origin: DVec3, options: &Options) -> Vec<u8> {
    let asset = concat!(r#""asset":{"version":"2.0","generator":"pcmvs "#, env!("CARGO_PKG_VERSION"), r#""}"#);
    let frame = Frame::of_mesh(mesh, origin);
    let bounds = match local_bounds(mesh, frame) {
        Some(bounds) if !mesh.triangles.is_empty() => bounds,
        _ => return container(format!("{{{asset}}}"), Vec::new()),
    };
    let mut file = Layout::default();
    file.put_mesh(mesh, frame, options.normals, bounds);
    let extras = options.up.map_or_else(String::new, |[x, y, z]| format!(r#","extras":{{"up":[{x},{y},{z}]}}"#));
    let DVec3 { x, y, z } = frame.translation;
    let node = if frame.is_far() { format!(r#","translation":[{x},{y},{z}]"#) } else { String::new() };
    let json = format!(
        concat!(
            r#"{{{asset},"extensionsUsed":["KHR_materials_unlit"],"#,
            r#""scene":0,"scenes":[{{"nodes":[0]{extras}}}],"nodes":[{{"mesh":0{node}}}],"#,
            r#""meshes":[{{"primitives":[{{{primitive}}}]}}],"#,
            r#""materials":[{{"pbrMetallicRoughness":{{"metallicFactor":0,"roughnessFactor":1}},"#,
            r#""extensions":{{"KHR_materials_unlit":{{}}}}}}],"#,
            r#""accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{{"byteLength":{length}}}]}}"#
        ),
        asset = asset,
        extras = extras,
        node = node,
        primitive = file.primitive,
        accessors = file.accessors.join(","),
        views = file.views.join(","),
        length = file.binary.len(),
    );
    container(json, file.binary)
}

/// The binary chunk under construction, and the parts of the JSON that describe it.
#[derive(Default)]
struct Layout {
    binary: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
    primitive: String,
}

impl Layout {
    fn put_mesh(&mut self, mesh: &Mesh, frame: Frame, normals: bool, [low, high]: [[f32; 3]; 2]) {
        let count = mesh.positions.len();
        let range = format!(r#","min":{},"max":{}"#, numbers(low), numbers(high));
        let start = self.binary.len();
        mesh.positions.iter().for_each(|&p| put(&mut self.binary, &frame.position(p)));
        let position = self.accessor(start, ARRAY_BUFFER, FLOAT, "VEC3", count, &range);
        let mut attributes = format!(r#""POSITION":{position}"#);
        if normals && mesh.normals.len() == count {
            let start = self.binary.len();
            mesh.normals.iter().for_each(|&n| put(&mut self.binary, &unit(n)));
            let normal = self.accessor(start, ARRAY_BUFFER, FLOAT, "VEC3", count, "");
            let _ = write!(attributes, r#","NORMAL":{normal}"#);
        }
        if mesh.colours.len() == count {
            // 16-bit colours would be smaller, but some readers mistake them for 8-bit colours. Linear 8-bit colours
            // lose detail in dark regions.
            let (start, table) = (self.binary.len(), linear_from_srgb());
            mesh.colours.iter().for_each(|c| put(&mut self.binary, &c.map(|v| table[usize::from(v)])));
            let colour = self.accessor(start, ARRAY_BUFFER, FLOAT, "VEC3", count, "");
            let _ = write!(attributes, r#","COLOR_0":{colour}"#);
        }
        let start = self.binary.len();
        let corners = mesh.triangles.iter().flatten();
        // The index 65535 is reserved for primitive restart. The largest index is therefore 65534, for 65535 vertices.
        let component = if count <= usize::from(u16::MAX) {
            corners.for_each(|&i| self.binary.extend_from_slice(&(i as u16).to_le_bytes()));
            5123
        } else {
            corners.for_each(|&i| self.binary.extend_from_slice(&i.to_le_bytes()));
            5125
        };
        let indices = self.accessor(start, ELEMENT_ARRAY_BUFFER, component, "SCALAR", mesh.triangles.len() * 3, "");
        self.primitive = format!(r#""attributes":{{{attributes}}},"indices":{indices},"material":0"#);
    }

    /// Describes the bytes from `start` to the end as a new buffer view and accessor. Returns their index.
    fn accessor(&mut self, start: usize, target: u32, component: u32, kind: &str, count: usize, range: &str) -> usize {
        let index = self.views.len();
        let length = self.binary.len() - start;
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length},"target":{target}}}"#));
        self.accessors.push(format!(
            r#"{{"bufferView":{index},"componentType":{component},"count":{count},"type":"{kind}"{range}}}"#
        ));
        index
    }
}

/// Assembles the chunks. Each is padded to a multiple of four bytes: JSON with spaces and binary data with zeros.
fn container(json: String, mut binary: Vec<u8>) -> Vec<u8> {
    let mut text = json.into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let chunks = [(JSON_CHUNK, &text), (BIN_CHUNK, &binary)];
    let chunks = chunks.iter().filter(|(_, bytes)| !bytes.is_empty());
    let length = 12 + chunks.clone().map(|(_, bytes)| 8 + bytes.len()).sum::<usize>();
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&(length as u32).to_le_bytes());
    for (kind, bytes) in chunks {
        out.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        out.extend_from_slice(&kind.to_le_bytes());
        out.extend_from_slice(bytes);
    }
    out
}

/// JSON of three numbers, with all digits of their double-precision values, so that readers get the same values.
fn numbers(v: [f32; 3]) -> String {
    let [x, y, z] = v.map(f64::from);
    format!("[{x},{y},{z}]")
}

/// Normalises a normal once more, because glTF requires unit length. The input differs only by rounding errors.
fn unit(n: Vec3) -> [f32; 3] {
    let length = libm::sqrtf(n.length_squared());
    if length > 0.0 { (n / length).to_array().map(|v| v + 0.0) } else { [0.0, 0.0, 1.0] }
}

/// Table from sRGB bytes to linear light in 0..=1 (IEC 61966-2-1).
fn linear_from_srgb() -> [f32; 256] {
    core::array::from_fn(|code| {
        let v = code as f64 / 255.0;
        (if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }) as f32
    })
}
