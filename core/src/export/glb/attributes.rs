//! The attributes of a mesh's vertices as a GLB file stores them: in single precision, or compact.
//!
//! A compact file (KHR_mesh_quantization) has positions with 14 to 16 bits, colours in linear light and texture coordinates with
//! 16 bits, and normals with 8 bits. Colours of a file that is compressed, too, are in `colours`.

use super::attribute::{self, Attribute};
use crate::{export::Frame, point_cloud::Mesh};
use alloc::{collections::BTreeMap, format, string::String, vec::Vec};
use glam::{DVec3, Vec3};

/// Least and most steps of compact positions along the longest side of a mesh.
const STEPS: [f64; 2] = [16383.0, 65535.0];
/// An edge of a mesh has at least so many steps, unless it takes more than the most. A mesh of preset `default`, whose edges are
/// 1.5 pixels of footprint long, then keeps its positions to 0.05 pixels.
const STEPS_PER_EDGE: f64 = 26.0;

/// Positions in single precision, in a file's frame.
pub(super) fn positions(mesh: &Mesh, frame: Frame, [low, high]: [[f32; 3]; 2]) -> Attribute {
    let range = format!(r#","min":{},"max":{}"#, numbers(low), numbers(high));
    Attribute { range, ..Attribute::floats("VEC3", mesh.positions.iter().map(|&p| frame.position(p))) }
}

/// Compact positions, and what takes them to a file's frame: a factor and an offset.
pub(super) fn compact_positions(mesh: &Mesh, frame: Frame, [low, high]: [[f32; 3]; 2]) -> (Attribute, f64, DVec3) {
    let [low, high] = [low, high].map(|corner| DVec3::from_array(corner.map(f64::from)));
    // One factor for all axes, because normals must stay perpendicular.
    let extent = (high - low).max_element();
    let edge = typical_edge(mesh);
    let steps = if edge > 0.0 { libm::ceil(STEPS_PER_EDGE * extent / edge) } else { 0.0 }.clamp(STEPS[0], STEPS[1]);
    let scale = if extent > 0.0 { extent / steps } else { 1.0 };
    let mut places = Places { last: steps as u16, taken: BTreeMap::new() };
    let stored = mesh.positions.iter().map(|&p| {
        let local = DVec3::from_array(frame.position(p).map(f64::from)) - low;
        places.place((local / scale).to_array().map(|v| libm::round(v) as u16), p)
    });
    let stored: Vec<[u16; 3]> = stored.collect();
    let [mut least, mut most] = [[u16::MAX; 3], [0; 3]];
    for value in &stored {
        for axis in 0..3 {
            least[axis] = least[axis].min(value[axis]);
            most[axis] = most[axis].max(value[axis]);
        }
    }
    let range = format!(r#","min":{least:?},"max":{most:?}"#);
    (Attribute { range, ..Attribute::shorts("VEC3", false, stored.into_iter()) }, scale, low)
}

/// The root of the mean square of the edges' lengths; 0 without triangles.
fn typical_edge(mesh: &Mesh) -> f64 {
    let at = |vertex: u32| mesh.positions[vertex as usize].as_dvec3();
    let squares = mesh.triangles.iter().map(|&[a, b, c]| {
        at(a).distance_squared(at(b)) + at(b).distance_squared(at(c)) + at(c).distance_squared(at(a))
    });
    libm::sqrt(squares.sum::<f64>() / (3 * mesh.triangles.len()).max(1) as f64)
}

/// The places of compact positions. Vertices at different positions get different places, so that readers which join vertices
/// at the same place find the same surface.
struct Places {
    /// Largest coordinate.
    last: u16,
    /// The positions at the places that are taken.
    taken: BTreeMap<[u16; 3], [u32; 3]>,
}

impl Places {
    /// The place of a vertex, or the first free one next to it.
    fn place(&mut self, place: [u16; 3], position: Vec3) -> [u16; 3] {
        let own = position.to_array().map(f32::to_bits);
        let steps = [0, 1, -1].into_iter();
        let around = steps.clone().flat_map(|z| steps.clone().flat_map(move |y| [0, 1, -1].map(|x| [x, y, z])));
        let near = around.map(|step| [0, 1, 2].map(|k| place[k].saturating_add_signed(step[k]).min(self.last)));
        for near in near {
            if *self.taken.entry(near).or_insert(own) == own {
                return near;
            }
        }
        place
    }
}

/// Normals in single precision.
pub(super) fn normals(mesh: &Mesh) -> Attribute {
    Attribute::floats("VEC3", mesh.normals.iter().map(|&n| unit(n)))
}

/// Normals with 8 bits.
pub(super) fn compact_normals(mesh: &Mesh) -> Attribute {
    let stored = mesh.normals.iter().flat_map(|&n| {
        let [x, y, z] = unit(n).map(|v| libm::roundf(v * 127.0) as i8 as u8);
        [x, y, z, 0]
    });
    let bytes = stored.collect();
    Attribute {
        component: attribute::BYTE,
        normalised: true,
        kind: "VEC3",
        stride: 4,
        used: 3,
        bytes,
        range: String::new(),
        filter: None,
    }
}

/// Linear colours in single precision. 16-bit colours would be smaller, but some readers mistake them for 8-bit colours.
/// Linear 8-bit colours lose detail in dark regions.
pub(super) fn colours(mesh: &Mesh) -> Attribute {
    let table = linear_from_srgb();
    Attribute::floats("VEC3", mesh.colours.iter().map(|c| c.map(|v| table[usize::from(v)])))
}

/// Linear colours with 16 bits, which are within one sRGB code. Among the numbers of a code the roundest is taken, so that files
/// shrink when they are sent compressed: in all but dark colours the lower byte is the same everywhere.
pub(super) fn compact_colours(mesh: &Mesh) -> Attribute {
    let table: [u16; 256] = core::array::from_fn(|code| {
        let at = |code: f64| libm::round(linear(code.clamp(0.0, 255.0)) * f64::from(u16::MAX)) as u16;
        roundest(at(code as f64 - WITHIN), at(code as f64 + WITHIN))
    });
    Attribute::shorts("VEC3", true, mesh.colours.iter().map(|c| c.map(|v| table[usize::from(v)])))
}

/// Largest deviation of a compact colour in sRGB codes.
pub(super) const WITHIN: f64 = 0.9;

/// The number from `low` to `high` with the most zeros at its end.
fn roundest(low: u16, high: u16) -> u16 {
    let mut best = low;
    for zeros in 0..16 {
        let step = 1u32 << zeros;
        let multiple = u32::from(low).next_multiple_of(step);
        if multiple > u32::from(high) {
            break;
        }
        best = multiple as u16;
    }
    best
}

/// Texture coordinates in single precision.
pub(super) fn uvs(uvs: &[[f32; 2]]) -> Attribute {
    Attribute::floats("VEC2", uvs.iter().copied())
}

/// Texture coordinates with 16 bits: fractions of a texel.
pub(super) fn compact_uvs(uvs: &[[f32; 2]]) -> Attribute {
    let step = |v: f32| libm::roundf(v.clamp(0.0, 1.0) * f32::from(u16::MAX)) as u16;
    Attribute::shorts("VEC2", true, uvs.iter().map(|uv| uv.map(step)))
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
    core::array::from_fn(|code| linear(code as f64) as f32)
}

/// Linear light of an sRGB code.
pub(super) fn linear(code: f64) -> f64 {
    let v = code / 255.0;
    if v <= 0.04045 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compact_colours_keep_their_code() {
        let colours: Vec<[u8; 3]> = (0..=255).map(|code| [code; 3]).collect();
        let attribute = compact_colours(&Mesh { colours, ..Mesh::default() });
        for (code, bytes) in attribute.bytes.chunks(attribute.stride).enumerate() {
            let stored = f64::from(u16::from_le_bytes([bytes[0], bytes[1]])) / 65535.0;
            let srgb =
                if stored <= 0.003_130_8 { 12.92 * stored } else { 1.055 * libm::pow(stored, 1.0 / 2.4) - 0.055 };
            assert!((srgb * 255.0 - code as f64).abs() < 0.95, "{code}: {}", srgb * 255.0);
        }
    }

    #[test]
    fn positions_of_finer_meshes_have_more_steps() {
        // Two small triangles, 1 apart.
        let off = |edge: f32| {
            let corners = [Vec3::ZERO, Vec3::new(edge, 0.0, 0.0), Vec3::new(0.0, edge, 0.0)];
            let positions: Vec<Vec3> = corners.into_iter().chain(corners.map(|p| Vec3::ONE - 0.37 * p)).collect();
            let mesh = Mesh { positions, triangles: Vec::from([[0, 1, 2], [3, 4, 5]]), ..Mesh::default() };
            let (attribute, scale, low) =
                compact_positions(&mesh, Frame::of_mesh(&mesh, DVec3::ZERO), [[0.0; 3], [1.0; 3]]);
            assert_eq!(low, DVec3::ZERO);
            let stored = attribute.bytes.chunks(attribute.stride).zip(&mesh.positions);
            let distance = |(bytes, position): (&[u8], &Vec3)| {
                let at = |k: usize| f64::from(u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]])) * scale;
                DVec3::new(at(0), at(1), at(2)).distance(position.as_dvec3())
            };
            (scale, stored.map(distance).fold(0.0, f64::max))
        };
        for (edge, steps) in [(0.1, 16383.0), (7e-4, 44000.0), (1e-4, 65535.0)] {
            let (scale, off) = off(edge);
            assert!((scale * steps - 1.0).abs() < 0.2 && off < 0.9 * scale, "{edge}: {scale}, {off}");
        }
    }

    #[test]
    fn different_positions_have_different_places() {
        let mut places = Places { last: 9, taken: BTreeMap::new() };
        let at = |x: f32| Vec3::new(x, 0.0, 0.0);
        assert_eq!(places.place([5, 5, 0], at(1.0)), [5, 5, 0]);
        assert_eq!(places.place([5, 5, 0], at(1.0)), [5, 5, 0], "a copy at the border of a chart");
        let next = places.place([5, 5, 0], at(1.1));
        assert!(next != [5, 5, 0] && next.iter().zip([5, 5, 0]).all(|(a, b)| a.abs_diff(b) <= 1), "{next:?}");
    }
}
