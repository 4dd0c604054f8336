//! Writes meshes and point clouds as the bytes of files: GLB for players and PLY for tools. The bytes are the same on
//! every machine.
//!
//! Coordinates are in single precision and in the scene's frame: [`crate::Rig::origin`] is added, and no axis is
//! changed.

pub mod glb;
pub mod ply;

use crate::point_cloud::Mesh;
use glam::{DVec3, Vec3};

/// Converts a position relative to the rig's origin to the scene's frame, in the precision of files; -0 becomes +0.
fn scene_position(position: Vec3, origin: DVec3) -> [f32; 3] {
    (origin + position.as_dvec3()).to_array().map(|v| v as f32 + 0.0)
}

/// Smallest and largest coordinates of a mesh, as written to files. `None` for a mesh without vertices.
pub fn bounds(mesh: &Mesh, origin: DVec3) -> Option<[[f32; 3]; 2]> {
    let first = scene_position(*mesh.positions.first()?, origin);
    Some(mesh.positions.iter().fold([first, first], |[mut low, mut high], &position| {
        let p = scene_position(position, origin);
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
