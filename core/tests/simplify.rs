//! Fewer triangles: closed, manifold and of the same topology, near the original, and the same every time.
#![allow(clippy::disallowed_methods, clippy::disallowed_types, reason = "no result depends on the tests' own numbers")]

mod common;

use common::{Random, assert_manifold, volume};
use glam::{DVec3, Vec3};
use pcmvs_core::grid::{BLOCK_NODES, SparseGrid};
use pcmvs_core::simplify::{SimplifyParams, simplify};
use pcmvs_core::surface::{Unstored, marching_cubes};
use pcmvs_core::{Error, Mesh, Progress, Serial, Silent, Stage, Workspace};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use studio::topology::components;

/// A solid by its signed distance, positive inside, in voxels.
type Solid = fn(Vec3) -> f32;

fn sphere(p: Vec3) -> f32 {
    17.0 - (p - 24.0).length()
}

fn torus(p: Vec3) -> f32 {
    let p = p - 24.2;
    let ring = (p.x * p.x + p.y * p.y).sqrt() - 13.0;
    5.0 - (ring * ring + p.z * p.z).sqrt()
}

fn two_bodies(p: Vec3) -> f32 {
    let ball = |x: f32, radius: f32| radius - (p - Vec3::new(x, 24.0, 24.0)).length();
    // 2.6 voxels apart.
    ball(14.0, 9.0).max(ball(34.0, 8.4))
}

/// 1.8 voxels thick.
fn plate(p: Vec3) -> f32 {
    let q = (p - 24.1).abs() - Vec3::new(16.0, 12.0, 0.9);
    -q.max(Vec3::ZERO).length() - q.max_element().min(0.0)
}

const SOLIDS: [(&str, Solid); 4] = [("sphere", sphere), ("torus", torus), ("two bodies", two_bodies), ("plate", plate)];

/// The surface of a solid, with colours that vary slowly.
fn surface_of(solid: Solid) -> Mesh {
    let grid = SparseGrid::new(Vec3::ZERO, 1.0, [6, 6, 6], |_| 0);
    let mut values = Vec::new();
    for block in &grid.blocks {
        for i in 0..BLOCK_NODES {
            let node = [i & 7, i >> 3 & 7, i >> 6];
            values.push(solid(Vec3::from_array(core::array::from_fn(|k| (8 * block[k] as usize + node[k]) as f32))));
        }
    }
    let unstored = Unstored { inside: 1.0, outside: -1.0 };
    let mut mesh = marching_cubes(&grid, &values, 0.0, unstored, &mut Workspace::default(), &Serial);
    mesh.colours = mesh.positions.iter().map(|p| p.to_array().map(|v| (4.0 * v) as u8 + 20)).collect();
    mesh
}

fn fewer(mesh: &Mesh, params: &SimplifyParams) -> Mesh {
    simplify(mesh, params, &Silent).expect("nobody cancels")
}

/// At most `faces` triangles, without a bound of the error.
fn unbounded(faces: u32) -> SimplifyParams {
    SimplifyParams { error_pixels: f32::INFINITY, ..SimplifyParams::new(faces, 1.0) }
}

/// Distance of a point from a triangle, by the nearest point of its plane or of its edges.
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let normal = (b - a).cross(c - a).normalize();
    let foot = p - normal * normal.dot(p - a);
    let inside = [(a, b), (b, c), (c, a)].into_iter().all(|(s, t)| (t - s).cross(foot - s).dot(normal) >= 0.0);
    let to_edge = |s: DVec3, t: DVec3| {
        let share = (p - s).dot(t - s) / (t - s).length_squared();
        (s.lerp(t, share.clamp(0.0, 1.0)) - p).length()
    };
    if inside { (foot - p).length() } else { to_edge(a, b).min(to_edge(b, c)).min(to_edge(c, a)) }
}

/// The largest distance of a vertex of one mesh from the other.
fn farthest(from: &Mesh, to: &Mesh) -> f64 {
    let triangles: Vec<[DVec3; 3]> =
        to.triangles.iter().map(|t| t.map(|v| to.positions[v as usize].as_dvec3())).collect();
    let distance = |p: DVec3| triangles.iter().map(|&t| to_triangle(p, t)).fold(f64::INFINITY, f64::min);
    from.positions.iter().map(|p| distance(p.as_dvec3())).fold(0.0, f64::max)
}

fn area(mesh: &Mesh) -> f64 {
    let double = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize].as_dvec3());
        (b - a).cross(c - a).length()
    };
    mesh.triangles.iter().map(double).sum::<f64>() / 2.0
}

/// Vertices minus edges plus triangles of a closed mesh.
fn euler(mesh: &Mesh) -> i64 {
    mesh.positions.len() as i64 - mesh.triangles.len() as i64 / 2
}

#[test]
fn surfaces_keep_their_topology_volume_area_and_place() {
    for (name, solid) in SOLIDS {
        let mesh = surface_of(solid);
        for faces in [mesh.triangles.len() as u32 / 4, 401, 200] {
            let found = fewer(&mesh, &unbounded(faces));
            assert_manifold(&found);
            let left = found.triangles.len() as u32;
            assert!((faces - 1..=faces).contains(&left), "{name}: {left} of {faces}");
            assert_eq!(euler(&found), euler(&mesh), "{name}");
            let (before, after) = (components(&mesh), components(&found));
            assert_eq!(before.len(), after.len(), "{name}");
            for (before, after) in before.iter().zip(&after) {
                assert!((after.volume / before.volume - 1.0).abs() < 1e-5, "{name}: {before:?}, {after:?}");
            }
            let change = area(&found) / area(&mesh) - 1.0;
            let error = farthest(&mesh, &found).max(farthest(&found, &mesh));
            // Chords of a curve of radius 5 to 17 voxels.
            let (most, largest) = if faces > 500 { (0.01, 0.5) } else { (0.04, 1.6) };
            assert!(change.abs() < most, "{name}, {faces}: the area changes by {change}");
            assert!(error < largest, "{name}, {faces}: {error}");
        }
    }
}

#[test]
fn flat_parts_need_few_triangles() {
    let mesh = surface_of(|p| {
        let q = (p - 24.3).abs() - Vec3::new(16.0, 12.0, 8.0);
        -q.max_element()
    });
    let found = fewer(&mesh, &SimplifyParams { colour_pixels: 0.0, ..unbounded(100) });
    assert_manifold(&found);
    assert!(found.triangles.len() <= 100, "{}", found.triangles.len());
    // The bevel of marching cubes along the box's edges is what is left.
    assert!(farthest(&mesh, &found) < 0.35, "{}", farthest(&mesh, &found));
}

#[test]
fn no_vertex_lies_farther_than_the_bound() {
    for (name, solid) in SOLIDS {
        let mesh = surface_of(solid);
        let mut before = 0;
        for error_pixels in [2.0, 0.5, 0.1] {
            // Half a voxel to a pixel.
            let params = SimplifyParams { error_pixels, ..SimplifyParams::new(0, 0.5) };
            let found = fewer(&mesh, &params);
            assert_manifold(&found);
            assert_eq!(euler(&found), euler(&mesh), "{name}");
            let error = farthest(&mesh, &found) / 0.5;
            assert!(error <= f64::from(error_pixels) * 1.0001, "{name}: {error} exceeds {error_pixels}");
            let left = found.triangles.len();
            assert!(left > before, "{name}: a closer bound needs more triangles");
            before = left;
        }
    }
}

#[test]
fn a_mesh_that_is_small_enough_is_returned_as_it_is() {
    let mesh = surface_of(sphere);
    assert_eq!(fewer(&mesh, &unbounded(mesh.triangles.len() as u32)), mesh);
    assert_eq!(fewer(&mesh, &unbounded(u32::MAX)), mesh);
    assert_eq!(fewer(&Mesh::default(), &unbounded(0)), Mesh::default());
}

#[test]
fn every_part_is_left_with_a_body() {
    let mesh = surface_of(two_bodies);
    let found = fewer(&mesh, &unbounded(0));
    assert_manifold(&found);
    assert_eq!(components(&found).len(), 2);
    let torus = fewer(&surface_of(torus), &unbounded(0));
    assert_manifold(&torus);
    assert_eq!(euler(&torus), 0);
}

/// The hash was made on x86-64; all machines must agree.
#[test]
fn results_are_the_same_every_time() {
    let mesh = surface_of(torus);
    let [a, b] = [0; 2].map(|_| fewer(&mesh, &SimplifyParams::new(600, 0.7)));
    assert_eq!(a, b);
    assert_eq!(format!("{:016x}", a.hash()), "9a2a24ca646bcf65");
}

#[test]
fn another_numbering_gives_the_same_surface() {
    let mesh = surface_of(torus);
    let last = mesh.positions.len() as u32 - 1;
    let mut other = mesh.clone();
    other.positions.reverse();
    other.normals.reverse();
    other.colours.reverse();
    other.triangles = mesh.triangles.iter().rev().map(|&[a, b, c]| [last - b, last - c, last - a]).collect();
    let [a, b] = [&mesh, &other].map(|mesh| fewer(mesh, &unbounded(1000)));
    assert_eq!(a.triangles.len(), b.triangles.len());
    assert!(farthest(&a, &b).max(farthest(&b, &a)) < 0.25, "{} {}", farthest(&a, &b), farthest(&b, &a));
}

#[test]
fn the_unit_of_length_does_not_matter() {
    let mesh = surface_of(torus);
    let mut large = mesh.clone();
    large.positions.iter_mut().for_each(|p| *p *= 4096.0);
    let found = fewer(&mesh, &SimplifyParams::new(600, 0.7));
    let mut other = fewer(&large, &SimplifyParams::new(600, 0.7 * 4096.0));
    other.positions.iter_mut().for_each(|p| *p /= 4096.0);
    assert_eq!(found.triangles, other.triangles);
    assert!(farthest(&found, &other) < 1e-4);
}

#[test]
fn a_step_of_colour_stays_where_it_is() {
    let mut mesh = surface_of(sphere);
    let side = |p: Vec3| if p.x + 0.3 * p.y > 30.0 { [220, 60, 40] } else { [30, 90, 200] };
    mesh.colours = mesh.positions.iter().map(|&p| side(p)).collect();
    let wrong = |colour_pixels: f32| {
        let found = fewer(&mesh, &SimplifyParams { colour_pixels, ..unbounded(600) });
        let error = |(p, c): (&Vec3, &[u8; 3])| u32::from(c[0].abs_diff(side(*p)[0]) > 40);
        found.positions.iter().zip(&found.colours).map(error).sum::<u32>()
    };
    let (with, without) = (wrong(2.0), wrong(1e-3));
    assert!(2 * with < without, "{with} vertices of the wrong colour, {without} without the rule");
}

#[test]
fn even_colours_are_kept() {
    let mut mesh = surface_of(torus);
    mesh.colours.fill([7, 130, 255]);
    let found = fewer(&mesh, &unbounded(500));
    assert!(found.colours.iter().all(|&c| c == [7, 130, 255]), "{:?}", found.colours.first());
    mesh.colours.clear();
    assert!(fewer(&mesh, &unbounded(500)).colours.is_empty());
}

#[test]
fn slow_changes_of_colour_are_kept() {
    let mesh = surface_of(sphere);
    let found = fewer(&mesh, &unbounded(500));
    for (p, c) in found.positions.iter().zip(&found.colours) {
        let expected = p.to_array().map(|v| 4.0 * v + 20.0);
        assert!((0..3).all(|k| (f32::from(c[k]) - expected[k]).abs() < 9.0), "{c:?} for {expected:?}");
    }
}

#[test]
fn normals_are_those_of_the_result() {
    let found = fewer(&surface_of(sphere), &unbounded(400));
    for (&p, &n) in found.positions.iter().zip(&found.normals) {
        assert!((p - 24.0).normalize().dot(n) > 0.97, "{n} at {p}");
    }
}

#[test]
fn open_edges_stay_as_they_are() {
    let mut mesh = surface_of(sphere);
    let lid = |t: &[u32; 3], mesh: &Mesh| t.iter().all(|&v| mesh.positions[v as usize].z > 36.0);
    let (gone, kept): (Vec<_>, Vec<_>) = mesh.triangles.iter().partition(|&t| lid(t, &mesh));
    let rim = |mesh: &[[u32; 3]]| -> Vec<u32> {
        let mut vertices: Vec<u32> = mesh.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    };
    let (above, below) = (rim(&gone), rim(&kept));
    mesh.triangles = kept;
    let found = fewer(&mesh, &unbounded(0));
    assert!(!found.triangles.is_empty());
    for v in above.into_iter().filter(|v| below.contains(v)) {
        assert!(found.positions.contains(&mesh.positions[v as usize]), "vertex {v} of the rim has moved");
    }
}

/// Cancels at a call.
struct Stop(std::sync::atomic::AtomicU32);

impl Progress for Stop {
    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        assert!(stage == Stage::Form && done <= total);
        self.0.fetch_sub(1, std::sync::atomic::Ordering::Relaxed) > 0
    }
}

#[test]
fn it_can_be_cancelled_at_every_report() {
    let mesh = surface_of(sphere);
    let run = |calls: u32| simplify(&mesh, &unbounded(100), &Stop(calls.into()));
    // A start, an end and a report per 1024 collapses.
    let reports = (0..).find(|&calls| run(calls).is_ok()).expect("it ends");
    assert!(reports >= 4, "{reports}");
    assert!((0..reports).all(|calls| run(calls) == Err(Error::Cancelled)));
}

/// The surface of a random field on two blocks by two by two.
fn random_surface(seed: u64, rare: usize) -> Mesh {
    let mut random = Random::new(seed);
    let grid = SparseGrid::new(Vec3::new(-1.0, 2.0, 0.5), 0.25, [2, 2, 2], |_| match random.below(8) {
        0 => SparseGrid::INSIDE,
        1 => SparseGrid::OUTSIDE,
        _ => 0,
    });
    let values: Vec<f32> = (0..grid.blocks.len() * BLOCK_NODES)
        .map(|_| if random.below(rare) == 0 { random.unit() } else { -random.unit() })
        .collect();
    let unstored = Unstored { inside: 1.0, outside: -1.0 };
    let mut mesh = marching_cubes(&grid, &values, 0.0, unstored, &mut Workspace::default(), &Serial);
    mesh.colours = mesh.positions.iter().map(|_| [0; 3].map(|_: u8| random.below(256) as u8)).collect();
    mesh
}

proptest! {
    #![proptest_config(Config { cases: 48, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..Config::default() })]

    /// Whatever the surface, its topology and volume stay, and the bound holds.
    #[test]
    fn random_surfaces_stay_closed_manifolds(
        seed in any::<u64>(), rare in 2..12usize, share in 0..9u32, bound in prop_oneof![Just(f32::INFINITY), 0.5..3.0f32],
    ) {
        let mesh = random_surface(seed, rare);
        let faces = mesh.triangles.len() as u32 / 10 * share;
        let params = SimplifyParams { error_pixels: bound, ..SimplifyParams::new(faces, 0.17) };
        let found = fewer(&mesh, &params);
        assert_manifold(&found);
        prop_assert!(found.triangles.len() < mesh.triangles.len());
        prop_assert_eq!(euler(&found), euler(&mesh));
        prop_assert_eq!(components(&found).len(), components(&mesh).len());
        prop_assert!((volume(&found) - volume(&mesh)).abs() < 1e-3 * volume(&mesh).abs().max(1.0));
        if bound.is_finite() && mesh.triangles.len() < 8000 {
            let error = farthest(&mesh, &found);
            prop_assert!(error <= f64::from(bound) * 0.17 * 1.0001, "{error} exceeds {bound}");
        }
    }
}
