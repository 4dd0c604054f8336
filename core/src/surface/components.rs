//! Removes stray components of a mesh.

use crate::{point_cloud::Mesh, workspace::Workspace};

/// Drops components whose volume is less than `smallest` times that of the largest component. Cavities have a negative
/// volume and are dropped too. Returns the number of dropped components.
pub fn drop_small_components(mesh: &mut Mesh, smallest: f32, workspace: &mut Workspace) -> u32 {
    let vertices = mesh.positions.len();
    let mut roots = workspace.empty(vertices);
    roots.extend(0..vertices as u32);
    for &[a, b, c] in &mesh.triangles {
        unite(&mut roots, a, b);
        unite(&mut roots, b, c);
    }
    // Parents have smaller indices, so that in ascending order the parent of each vertex is already a root.
    for v in 0..vertices {
        roots[v] = roots[roots[v] as usize];
    }

    let mut volumes = workspace.filled(0.0_f64, vertices);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].as_dvec3());
        volumes[roots[triangle[0] as usize] as usize] += a.dot(b.cross(c)) / 6.0;
    }
    let largest = volumes.iter().fold(0.0, |a: f64, &v| a.max(v));
    let kept = |root: u32| {
        let volume = volumes[root as usize];
        volume > 0.0 && volume >= f64::from(smallest) * largest
    };
    let is_root = |&(v, &root): &(usize, &u32)| v as u32 == root;
    let dropped = roots.iter().enumerate().filter(is_root).filter(|&(_, &root)| !kept(root)).count() as u32;
    if dropped == 0 {
        workspace.recycle(roots);
        workspace.recycle(volumes);
        return 0;
    }

    const GONE: u32 = u32::MAX;
    let mut renamed = workspace.filled(GONE, vertices);
    let mut count = 0;
    for (v, &root) in roots.iter().enumerate() {
        if kept(root) {
            renamed[v] = count;
            mesh.positions[count as usize] = mesh.positions[v];
            mesh.normals[count as usize] = mesh.normals[v];
            count += 1;
        }
    }
    mesh.positions.truncate(count as usize);
    mesh.normals.truncate(count as usize);
    mesh.triangles.retain_mut(|triangle| {
        *triangle = triangle.map(|v| renamed[v as usize]);
        triangle[0] != GONE
    });
    workspace.recycle(roots);
    workspace.recycle(volumes);
    workspace.recycle(renamed);
    dropped
}

fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        let above = parent[parent[v as usize] as usize];
        parent[v as usize] = above;
        v = above;
    }
    v
}

/// Unites two sets. The smaller root becomes the new root, so that the result does not depend on the order of the
/// calls.
fn unite(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}
