//! Binary little-endian PLY, for tools that inspect meshes and point clouds.

use super::{Frame, put};
use crate::point_cloud::{Mesh, PointCloud};
use alloc::{format, string::String, vec::Vec};
use glam::{DVec3, Vec3};

/// The properties of a vertex that all files have. Positions of an object far from the scene's origin are doubles.
fn vectors(frame: Frame) -> String {
    let kind = if frame.is_far() { "double" } else { "float" };
    format!(
        "property {kind} x\nproperty {kind} y\nproperty {kind} z\nproperty float nx\nproperty float ny\nproperty float nz\n"
    )
}

fn put_position(out: &mut Vec<u8>, frame: Frame, position: Vec3) {
    let local = frame.position(position);
    if frame.is_far() {
        let exact = frame.translation + DVec3::from_array(local.map(f64::from));
        exact.to_array().iter().for_each(|v| out.extend_from_slice(&v.to_le_bytes()));
    } else {
        put(out, &local);
    }
}

fn header(comment: &str, elements: &str) -> Vec<u8> {
    let version = env!("CARGO_PKG_VERSION");
    format!("ply\nformat binary_little_endian 1.0\ncomment pcmvs {version}\n{comment}{elements}end_header\n")
        .into_bytes()
}

/// Writes a mesh as the bytes of a PLY file: positions in the scene's frame (`origin` is [`crate::Rig::origin`]),
/// normals, sRGB colours if the mesh has them, and triangles.
pub fn write_mesh(mesh: &Mesh, origin: DVec3) -> Vec<u8> {
    let frame = Frame::of_mesh(mesh, origin);
    let vectors = vectors(frame);
    let coloured = mesh.colours.len() == mesh.positions.len() && !mesh.colours.is_empty();
    let colours = if coloured { "property uchar red\nproperty uchar green\nproperty uchar blue\n" } else { "" };
    let mut out = header(
        "",
        &format!(
            "element vertex {}\n{vectors}{colours}element face {}\nproperty list uchar uint vertex_indices\n",
            mesh.positions.len(),
            mesh.triangles.len()
        ),
    );
    for (i, &position) in mesh.positions.iter().enumerate() {
        put_position(&mut out, frame, position);
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
    let frame = Frame::new(cloud.iter().map(|point| point.position), origin);
    let vectors = vectors(frame);
    let mut out = header(
        "comment rank 0 implicit, 1 substituted, 2 detected, 3 frontier\n",
        &format!(
            "element vertex {}\n{vectors}property float fidelity\nproperty float sigma\nproperty float weight\n\
             property ushort view\nproperty uchar rank\n",
            cloud.len()
        ),
    );
    for point in cloud {
        put_position(&mut out, frame, point.position);
        put(&mut out, &point.normal.to_array());
        put(&mut out, &[point.fidelity, point.sigma, point.weight]);
        out.extend_from_slice(&point.view.to_le_bytes());
        out.push(point.rank as u8);
    }
    out
}
