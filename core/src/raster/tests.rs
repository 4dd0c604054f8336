//! Crossings of rays with closed meshes against bodies that are known exactly.

use super::*;
use crate::{
    executor::Serial,
    hull::VisualHull,
    params::{Params, Preset},
    progress::Silent,
    testing::{both, cuboid, pinhole, ring, silhouette_of, sphere, torus},
    workspace::Workspace,
};

/// What a sphere's triangles err by: their corners lie on the surface, and they sag in between.
const CONVEX: [f32; 2] = [1e-5, 0.002];
/// What a torus's err by: along its hole they bulge.
const SADDLE: [f32; 2] = [0.002, 0.002];

/// Signed distance to a surface, positive inside.
type Solid<'a> = &'a dyn Fn(Vec3) -> f32;

fn intervals(crossings: &mut Crossings, pixel: usize) -> Vec<(f32, f32)> {
    let mut found = Vec::new();
    crossings.intervals(pixel, |i| found.push((i.near, i.far)));
    found
}

/// Checks every pixel's intervals: in order, with ends on the surface, inside between them and outside elsewhere, as far
/// as depths of `reach`. The mesh lies at most `out` outside the true surface and at most `sag` inside. The answer is how
/// many rays have how many intervals.
fn check(mesh: &Mesh, solid: Solid, camera: &Pinhole, reach: (f32, f32), [out, sag]: [f32; 2]) -> [usize; 8] {
    let mut crossings = Crossings::default();
    crossings.find(mesh, camera);
    let mut rays = [0; 8];
    for pixel in 0..(camera.width * camera.height) as usize {
        let at = |depth| {
            let (x, y) = (pixel as u32 % camera.width, pixel as u32 / camera.width);
            camera.unproject(x as f32, y as f32, depth)
        };
        let found = intervals(&mut crossings, pixel);
        rays[found.len()] += 1;
        assert!(found.iter().all(|i| i.0 <= i.1), "pixel {pixel}: {found:?}");
        assert!(found.windows(2).all(|w| w[0].1 <= w[1].0), "pixel {pixel}: {found:?}");
        for end in found.iter().flat_map(|i| [i.0, i.1]) {
            assert!((-out..sag).contains(&solid(at(end))), "pixel {pixel}: {end} is {} off", solid(at(end)));
        }
        for k in 0..=200 {
            let depth = reach.0 + (reach.1 - reach.0) * k as f32 / 200.0;
            let (d, held) = (solid(at(depth)), found.iter().any(|i| (i.0..=i.1).contains(&depth)));
            assert!(if held { d > -out } else { d < sag }, "pixel {pixel} at {depth}: {d}, {found:?}");
        }
    }
    rays
}

#[test]
fn rays_through_a_sphere_enter_and_leave_once() {
    let (centre, radius) = (Vec3::new(0.1, -0.2, 0.3), 0.7);
    let solid = |p: Vec3| radius - (p - centre).length();
    for from in [Vec3::new(3.0, 0.5, 1.0), Vec3::new(-0.4, 0.3, -3.0)] {
        let camera = pinhole(from, Vec3::ZERO, 64, 90.0);
        let rays = check(&sphere(centre, radius), &solid, &camera, (1.5, 4.5), CONVEX);
        assert!(rays[0] > 1000 && rays[1] > 1000 && rays[2..] == [0; 6], "{rays:?}");
    }
}

#[test]
fn rays_through_two_spheres_enter_and_leave_each() {
    let (a, b) = (Vec3::new(0.7, 0.0, 0.0), Vec3::new(-0.6, 0.1, 0.1));
    let solid = |p: Vec3| (0.5 - (p - a).length()).max(0.6 - (p - b).length());
    let meshes = [both(sphere(a, 0.5), &sphere(b, 0.6)), both(sphere(b, 0.6), &sphere(a, 0.5))];
    for mesh in meshes {
        let rays = check(&mesh, &solid, &pinhole(Vec3::X * 3.0, Vec3::ZERO, 64, 90.0), (1.0, 5.0), CONVEX);
        assert!(rays[1] > 100 && rays[2] > 500 && rays[3..] == [0; 5], "{rays:?}");
    }
}

#[test]
fn rays_through_a_torus_enter_and_leave_its_limbs() {
    let solid = |p: Vec3| {
        let across = libm::hypotf(p.x, p.y) - 0.7;
        0.25 - libm::hypotf(across, p.z)
    };
    // From the side, where rays pass two limbs, from above through the hole, and at a slant.
    for from in [Vec3::X * 3.0, Vec3::Z * 3.0, Vec3::new(2.2, 0.4, 0.5)] {
        let camera = pinhole(from, Vec3::ZERO, 64, 80.0);
        let rays = check(&torus(0.7, 0.25), &solid, &camera, (1.2, 4.5), SADDLE);
        assert!(rays[0] > 1000 && rays[1] > 500 && rays[3..] == [0; 5], "{rays:?}");
        // From above a ray passes one limb. One that grazes the hole may pass two bulges of its triangles.
        assert!(if from.z < 2.0 { rays[2] > 100 } else { rays[2] < 10 }, "{rays:?}");
    }
}

/// Rays that meet an edge or a corner meet all triangles around it, or those on one side; they enter and leave once.
#[test]
fn rays_through_edges_and_corners_count_once() {
    // The pixel in the middle looks along z; a pixel's ray runs through (x, y, 1) · depth, x and y in tenths.
    let camera = pinhole(Vec3::ZERO, Vec3::Z, 21, 10.0);
    let middle = camera.ray(10.0, 10.0);
    assert!((middle - Vec3::Z).length() < 1e-6);
    // Corners, edges and both sides' diagonals of these boxes project to pixel centres.
    let near = cuboid(Vec3::new(-1.0, -1.0, 2.0), Vec3::new(1.0, 1.0, 4.0));
    let far = cuboid(Vec3::new(-2.0, -2.0, 5.0), Vec3::new(2.0, 2.0, 8.0));
    let mut crossings = Crossings::default();
    crossings.find(&both(near, &far), &camera);
    for pixel in 0..21 * 21 {
        let (x, y) = (pixel % 21, pixel / 21);
        let off = (x as i32 - 10).abs().max((y as i32 - 10).abs());
        let found = intervals(&mut crossings, pixel);
        // The faces in front cover 5 and 4 pixels to either side; aside of the back faces rays leave through the sides.
        let expected: &[(f32, f32)] = match off {
            0..=2 => &[(2.0, 4.0), (5.0, 8.0)],
            3 => &[(2.0, 1.0 / 0.3), (5.0, 2.0 / 0.3)],
            4 => &[(2.0, 2.5), (5.0, 5.0)],
            5 => &[(2.0, 2.0)],
            _ => &[],
        };
        // A ray along a silhouette touches: it may have a piece without length there, or none.
        let solid = |i: &&(f32, f32)| i.1 - i.0 > 1e-4;
        let (found, expected): (Vec<_>, Vec<_>) =
            (found.iter().filter(solid).collect(), expected.iter().filter(solid).collect());
        assert_eq!(found.len(), expected.len(), "({x}, {y}): {found:?}");
        for (a, b) in found.iter().zip(expected) {
            assert!((a.0 - b.0).abs() < 1e-4 && (a.1 - b.1).abs() < 1e-4, "({x}, {y}): {found:?}");
        }
    }
}

/// Along every ray the hull's mesh holds what the hull's signed distance allows, to a pixel's footprint.
#[test]
fn rays_through_the_hulls_mesh_run_where_no_silhouette_excludes() {
    let balls = [(Vec3::new(0.35, 0.0, 0.0), 0.4), (Vec3::new(-0.45, 0.1, 0.1), 0.3)];
    let cameras = ring(6, 3.0, 0.8).chain(ring(4, 2.9, -0.9)).map(|from| pinhole(from, Vec3::ZERO, 160, 220.0));
    let views: Vec<_> = cameras.enumerate().map(|(i, c)| silhouette_of(&balls, &c, i as u16)).collect();
    let hull = VisualHull::new(&views, &Params::preset(Preset::Hull).hull, &Silent).expect("there is a hull");
    let (mesh, footprint) = (hull.mesh(&mut Workspace::default(), &Serial), hull.footprint());
    // From a camera and from where none stands.
    for from in [views[0].camera.centre, Vec3::new(2.9, 0.3, 0.2)] {
        let camera = pinhole(from, Vec3::ZERO, 64, 88.0);
        let solid = |p: Vec3| hull.signed_distance(p) / footprint;
        let rays = check(&mesh, &solid, &camera, (1.8, 4.2), [1.0, 1.0]);
        assert!(rays[0] > 1000 && rays[1] > 300 && rays[2] > 10, "{rays:?}");
    }
}
