//! Writes meshes and point clouds as the bytes of files: GLB for players and PLY for tools. The bytes are the same on
//! every machine.
//!
//! Coordinates are in the scene's frame: [`crate::Rig::origin`] is added, and no axis is changed. They are in single
//! precision, unless the object is so far from the scene's origin that rounding would spoil its shape, as in surveyors'
//! coordinates. Then a PLY has them in double precision, and a GLB has them relative to a node with a translation.

pub mod glb;
pub mod ply;

use crate::{math::max, point_cloud::Mesh};
use glam::{DVec3, Vec3};

/// An object is far away if its origin's distance from that of the scene along an axis is at least this many times the
/// object's own size. Up to there, single precision moves no vertex by more than 2^-16 of the size.
const FAR: f64 = 256.0;

/// How the positions of a file are written.
#[derive(Debug, Clone, Copy)]
struct Frame {
    /// What must be added to the file's single-precision positions. Zero, unless the object is far away. It is exact in
    /// single precision itself.
    translation: DVec3,
    /// The rest of the origin, which is added to the positions before they are written.
    origin: DVec3,
}

impl Frame {
    /// The frame for positions relative to an origin.
    fn new(positions: impl Iterator<Item = Vec3>, origin: DVec3) -> Self {
        // Positions are relative to the rig's origin, which is close to the object.
        let size = positions.fold(0.0, |size, p| max(size, p.abs().max_element()));
        let is_far = size > 0.0 && origin.abs().max_element() >= FAR * f64::from(size);
        let translation = if is_far { origin.as_vec3().as_dvec3() + 0.0 } else { DVec3::ZERO };
        Self { translation, origin: origin - translation }
    }

    fn of_mesh(mesh: &Mesh, origin: DVec3) -> Self {
        Self::new(mesh.positions.iter().copied(), origin)
    }

    fn is_far(&self) -> bool {
        self.translation != DVec3::ZERO
    }

    /// A position in the file's frame; -0 becomes +0.
    fn position(&self, position: Vec3) -> [f32; 3] {
        (self.origin + position.as_dvec3()).to_array().map(|v| v as f32 + 0.0)
    }
}

/// Smallest and largest coordinates of a mesh in the scene's frame, as written to files. `None` for a mesh without
/// vertices.
pub fn bounds(mesh: &Mesh, origin: DVec3) -> Option<[[f64; 3]; 2]> {
    let frame = Frame::of_mesh(mesh, origin);
    let in_scene = |corner: [f32; 3]| (frame.translation + DVec3::from_array(corner.map(f64::from))).to_array();
    local_bounds(mesh, frame).map(|corners| corners.map(in_scene))
}

/// Smallest and largest coordinates of a mesh in a file's frame.
fn local_bounds(mesh: &Mesh, frame: Frame) -> Option<[[f32; 3]; 2]> {
    let first = frame.position(*mesh.positions.first()?);
    Some(mesh.positions.iter().fold([first, first], |[mut low, mut high], &position| {
        let p = frame.position(position);
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
        [low, high]
    }))
}

fn put(out: &mut alloc::vec::Vec<u8>, numbers: &[f32]) {
    for v in numbers {
        out.extend_from_slice(&v.to_le_bytes());
    }
}
