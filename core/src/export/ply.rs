//! Binary little-endian PLY, for tools that inspect meshes and point clouds.

use super::{put, scene_position};
use crate::point_cloud::{Mesh, PointCloud};
use alloc::{format, vec::Vec};
use glam::DVec3;

const VECTORS: &str = "property float x\nproperty float y\nproperty float z\n\
                       property float nx\nproperty float ny\nproperty float nz\n";

fn header(comment: &str, elements: &str) -> Vec<u8> {
    let version = env!("CARGO_PKG_VERSION");
    format!("ply\nformat binary_little_endian 1.0\ncomment pcmvs {version}\n{comment}{elements}end_header\n")
        .into_bytes()
}

/// Writes a mesh as the bytes of a PLY file: positions in the scene's frame (`origin` is [`crate::Rig::origin`]),
/// normals, sRGB colours if the mesh has them, and triangles.
pub fn write_mesh(mesh: &Mesh, origin: DVec3) -> Vec<u8> {
    let coloured = mesh.colours.len() == mesh.positions.len() && !mesh.colours.is_empty();
    let colours = if coloured { "property uchar red\nproperty uchar green\nproperty uchar blue\n" } else { "" };
    let mut out = header(
        "",
        &format!(
            "element vertex {}\n{VECTORS}{colours}element face {}\nproperty list uchar uint vertex_indices\n",
            mesh.positions.len(),
            mesh.triangles.len()
        ),
    );
    for (i, &position) in mesh.positions.iter().enumerate() {
        put(&mut out, &scene_position(position, origin));
        put(&mut out, &mesh.normals[i].to_array());
        if coloured {
            out.extend_from_slice(&mesh.colours[i]);
        }
    }
    for triangle in &mesh.triangles {
        out.push(3);
        triangle.iter().for_each(|i| out.extend_from_slice(&i.to_le_bytes()));
    }
    out
}

/// Writes a point cloud as the bytes of a PLY file: position in the scene's frame (`origin` is [`crate::Rig::origin`]),
/// normal, fidelity, standard deviation in pixels of footprint, weight, detecting view (65535 for none) and rank (the
/// value of [`crate::Rank`]).
pub fn write_cloud(cloud: &PointCloud, origin: DVec3) -> Vec<u8> {
    let mut out = header(
        "comment rank 0 implicit, 1 substituted, 2 detected, 3 frontier\n",
        &format!(
            "element vertex {}\n{VECTORS}property float fidelity\nproperty float sigma\nproperty float weight\n\
             property ushort view\nproperty uchar rank\n",
            cloud.len()
        ),
    );
    for point in cloud {
        put(&mut out, &scene_position(point.position, origin));
        put(&mut out, &point.normal.to_array());
        put(&mut out, &[point.fidelity, point.sigma, point.weight]);
        out.extend_from_slice(&point.view.to_le_bytes());
        out.push(point.rank as u8);
    }
    out
}
