//! What the unit tests share: cameras, bodies with known surfaces, and how laws are tested.

use crate::{
    camera::{Camera, Pinhole},
    lens::Lens,
    point_cloud::{Mesh, Point, Rank},
    silhouette::Silhouette,
    view::View,
};
use alloc::{sync::Arc, vec, vec::Vec};
use core::f32::consts::{PI, TAU};
use glam::{DMat3, DVec3, Vec3};
use proptest::test_runner::{Config, RngSeed};

/// Runs a law on `cases` inputs, the same ones every time.
pub fn law(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..Config::default() }
}

/// A camera of `size` x `size` pixels and focal length `focal` that looks from a place at another.
pub fn camera(from: Vec3, at: Vec3, size: u32, focal: f64) -> Camera {
    let from = from.as_dvec3();
    let forward = (at.as_dvec3() - from).normalize();
    let up = if forward.z.abs() < 0.9 { DVec3::Z } else { DVec3::Y };
    let right = forward.cross(up).normalize();
    let r = DMat3::from_cols(right, forward.cross(right), forward).transpose();
    let centre = f64::from(size - 1) / 2.0;
    Camera {
        width: size,
        height: size,
        k: [[focal, 0.0, centre], [0.0, focal, centre], [0.0, 0.0, 1.0]],
        lens: Lens::NONE,
        r: r.transpose().to_cols_array_2d(),
        t: (-(r * from)).to_array(),
    }
}

/// [`camera`] as the stages use it.
pub fn pinhole(from: Vec3, at: Vec3, size: u32, focal: f64) -> Pinhole {
    Pinhole::new(&camera(from, at, size, focal), DVec3::ZERO)
}

/// A point of weight 1.
pub fn point(position: Vec3, normal: Vec3, view: u16, fidelity: f32) -> Point {
    Point { position, normal, fidelity, sigma: 0.0, weight: 1.0, view, rank: Rank::Detected }
}

/// The same with a rank.
pub fn ranked(point: Point, rank: Rank) -> Point {
    Point { rank, ..point }
}

/// A closed mesh that is the image of the square [0, 1)² under `place`, periodic in both directions unless `poles`:
/// then its first and last rows are points. Counter-clockwise seen from outside if (∂u, ∂v, outward) is right-handed.
fn wrapped(columns: u32, rows: u32, poles: bool, place: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    let at =
        |c: u32, r: u32| if poles { 1 + (r - 1) * columns + c % columns } else { r % rows * columns + c % columns };
    let inner = if poles { 1..rows } else { 0..rows };
    if poles {
        mesh.positions.push(place(0.0, 0.0));
    }
    for r in inner {
        mesh.positions.extend((0..columns).map(|c| place(c as f32 / columns as f32, r as f32 / rows as f32)));
    }
    if poles {
        mesh.positions.push(place(0.0, 1.0));
    }
    let last = mesh.positions.len() as u32 - 1;
    for c in 0..columns {
        for r in 0..rows {
            match (poles, r) {
                (true, 0) => mesh.triangles.push([0, at(c + 1, 1), at(c, 1)]),
                (true, r) if r + 1 == rows => mesh.triangles.push([last, at(c, r), at(c + 1, r)]),
                _ => {
                    mesh.triangles.push([at(c, r), at(c + 1, r), at(c + 1, r + 1)]);
                    mesh.triangles.push([at(c, r), at(c + 1, r + 1), at(c, r + 1)]);
                }
            }
        }
    }
    mesh.normals = vec![Vec3::ZERO; mesh.positions.len()];
    mesh
}

/// A sphere whose triangles sag by at most 0.2 % of its radius.
pub fn sphere(centre: Vec3, radius: f32) -> Mesh {
    let mut mesh = wrapped(128, 64, true, |u, v| {
        let (theta, phi) = (PI * (1.0 - v), TAU * u);
        let ring = libm::sinf(theta);
        centre + Vec3::new(ring * libm::cosf(phi), ring * libm::sinf(phi), libm::cosf(theta)) * radius
    });
    mesh.normals = mesh.positions.iter().map(|&p| (p - centre) / radius).collect();
    mesh
}

/// A torus around the z axis: the radius of its ring and of its tube.
pub fn torus(ring: f32, tube: f32) -> Mesh {
    wrapped(160, 80, false, |u, v| {
        let (phi, psi) = (TAU * u, TAU * v);
        let across = ring + tube * libm::cosf(psi);
        Vec3::new(across * libm::cosf(phi), across * libm::sinf(phi), tube * libm::sinf(psi))
    })
}

/// A box with two triangles on each side.
pub fn cuboid(low: Vec3, high: Vec3) -> Mesh {
    let corner = |i: u32| Vec3::select(glam::BVec3::new(i & 1 != 0, i & 2 != 0, i & 4 != 0), high, low);
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Mesh {
        positions: (0..8).map(corner).collect(),
        triangles: sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Mesh::default()
    }
}

/// Two meshes as one.
pub fn both(mut a: Mesh, b: &Mesh) -> Mesh {
    let first = a.positions.len() as u32;
    a.positions.extend(&b.positions);
    a.normals.extend(&b.normals);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|i| first + i)));
    a
}

/// A view without picture that sees balls, given by centre and radius, as its silhouette.
pub fn silhouette_of(balls: &[(Vec3, f32)], camera: &Pinhole, index: u16) -> View {
    // The distance of a ray from a ball in pixels of footprint gives coverage to within a few hundredths of a pixel.
    let coverage = |i: u32| {
        let ray = camera.ray((i % camera.width) as f32, (i / camera.width) as f32).normalize();
        let covered = balls.iter().map(|&(centre, radius)| {
            let to = centre - camera.centre;
            let along = to.dot(ray);
            (radius - (to - ray * along).length()) / camera.footprint(along) + 0.5
        });
        (covered.fold(0.0, f32::max).clamp(0.0, 1.0) * 255.0) as u8
    };
    let coverage: Vec<u8> = (0..camera.width * camera.height).map(coverage).collect();
    let silhouette = Silhouette::from_coverage(camera.width, camera.height, &coverage, |_| true);
    View::of_silhouette(index, *camera, Some(Arc::new(silhouette.expect("a contour"))))
}

/// Places on a ring of `radius` around the z axis at `height`.
pub fn ring(count: u32, radius: f32, height: f32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |i| {
        let turn = TAU * i as f32 / count as f32;
        Vec3::new(radius * libm::cosf(turn), radius * libm::sinf(turn), height)
    })
}
