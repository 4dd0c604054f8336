//! Meshing against surfaces that are known exactly.
#![allow(clippy::disallowed_methods, clippy::disallowed_types, reason = "no result depends on the tests' own numbers")]

mod common;

use std::sync::atomic::{AtomicU32, Ordering};

use common::{Random, assert_manifold};
use glam::Vec3;
use pcmvs_core::mesh::{Meshed, MeshingParams, SpaceConstraint, mesh};
use pcmvs_core::surface::{Envelope, drop_small_components};
use pcmvs_core::{Error, Mesh, Params, Point, Preset, Progress, Rank, Serial, Silent, Stage, Workspace};

/// A solid by its signed distance, positive inside.
type Solid = fn(Vec3) -> f32;

struct Hull<F: Fn(Vec3) -> f32 + Sync>(F);

impl<F: Fn(Vec3) -> f32 + Sync> Envelope for Hull<F> {
    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::splat(-0.6), Vec3::splat(0.6))
    }

    fn signed_distance(&self, p: Vec3) -> f32 {
        self.0(p)
    }
}

const VOXEL: f32 = 1.2 / 72.0;

fn sphere(p: Vec3) -> f32 {
    0.5 - p.length()
}

fn torus(p: Vec3) -> f32 {
    let ring = (p.x * p.x + p.y * p.y).sqrt() - 0.38;
    0.15 - (ring * ring + p.z * p.z).sqrt()
}

/// Four fingers 3.4 voxels thick with gaps of 2.3 voxels, as a hand's are.
fn fingers(p: Vec3) -> f32 {
    let finger = |i: i32| {
        let x = (i as f32 - 1.5) * 5.7 * VOXEL;
        1.7 * VOXEL - Vec3::new(p.x - x, p.y - p.y.clamp(-0.3, 0.3), p.z).length()
    };
    (0..4).map(finger).fold(f32::MIN, f32::max)
}

fn outward(solid: Solid, p: Vec3) -> Vec3 {
    let along = |axis: Vec3| solid(p - axis * 1e-3) - solid(p + axis * 1e-3);
    Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z)).normalize()
}

fn point(position: Vec3, normal: Vec3, weight: f32) -> Point {
    Point { position, normal, fidelity: 1.0, sigma: 0.0, weight, view: 0, rank: Rank::Detected }
}

/// Points spread at random over the surface, so many a square voxel, where `keep` says so.
fn cloud(solid: Solid, density: f32, keep: impl Fn(Vec3) -> bool) -> Vec<Point> {
    let mut random = Random::new(17);
    // A shell of one voxel to either side holds 2 cubic voxels for each square voxel of surface.
    let count = (1.2 / VOXEL).powi(3) * density / 2.0;
    let mut points = Vec::new();
    for _ in 0..count as u32 {
        let p = Vec3::new(random.unit(), random.unit(), random.unit()) * 1.2 - 0.6;
        if solid(p).abs() < VOXEL && keep(p) {
            let p = p + outward(solid, p) * solid(p);
            points.push(point(p, outward(solid, p), 1.0));
        }
    }
    points
}

fn params() -> MeshingParams {
    Params::preset(Preset::Default).meshing
}

fn run(points: &[Point], hull: impl Fn(Vec3) -> f32 + Sync, params: &MeshingParams) -> Meshed {
    let meshed = mesh(points.into(), &Hull(hull), VOXEL, params, &mut Workspace::default(), &Serial, &Silent).unwrap();
    assert_manifold(&meshed.mesh);
    meshed
}

/// Share `rank` of the vertices is nearer to the surface than this, in voxels.
fn error(mesh: &Mesh, solid: Solid, rank: f32) -> f32 {
    quantile(mesh.positions.iter().map(|&p| solid(p).abs() / VOXEL), rank)
}

fn quantile(values: impl Iterator<Item = f32>, rank: f32) -> f32 {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values[(rank * (values.len() - 1) as f32) as usize]
}

/// Median angle in degrees between the mesh's normals and the surface's.
fn median_angle(mesh: &Mesh, solid: Solid) -> f32 {
    let normals = mesh.positions.iter().zip(&mesh.normals);
    quantile(normals.map(|(&p, &n)| outward(solid, p).dot(n).clamp(-1.0, 1.0).acos().to_degrees()), 0.5)
}

#[test]
fn surfaces_are_met_within_a_small_part_of_a_voxel() {
    for solid in [sphere as Solid, torus] {
        let points = cloud(solid, 1.5, |_| true);
        let ways = [(None, None), (Some(SpaceConstraint::Envelope), Some(4.0)), (Some(SpaceConstraint::Rectify), None)];
        for (space_constraint, screening) in ways {
            let params = MeshingParams { space_constraint, screening, ..params() };
            let mesh = run(&points, solid, &params).mesh;
            assert!(error(&mesh, solid, 0.5) < 0.03);
            assert!(error(&mesh, solid, 0.9) < 0.08);
            assert!(error(&mesh, solid, 1.0) < 0.35);
            assert!(median_angle(&mesh, solid) < 2.0);
        }
    }
}

#[test]
fn noise_averages_out() {
    let mut random = Random::new(23);
    let mut points = cloud(sphere, 1.5, |_| true);
    for point in &mut points {
        point.position += Vec3::new(random.normal(), random.normal(), random.normal()) * (0.3 * VOXEL);
    }
    let mesh = run(&points, |p| sphere(p) + 0.05, &params()).mesh;
    let of_points = quantile(points.iter().map(|p| sphere(p.position).abs() / VOXEL), 0.9);
    assert!(error(&mesh, sphere, 0.9) < 0.5 * of_points);
}

/// The noise of points that are known to be imprecise shows less. Points that are known to be precise keep more of an
/// edge.
#[test]
fn imprecise_points_make_a_calm_surface_and_precise_ones_an_edge() {
    let mut random = Random::new(31);
    let mut points = cloud(sphere, 1.5, |_| true);
    for point in &mut points {
        point.position += point.normal * (random.normal() * 0.5 * VOXEL);
        let error = Vec3::new(random.normal(), random.normal(), random.normal()) * 0.3;
        point.normal = (point.normal + error).normalize();
        point.sigma = 1.0;
    }
    let angle = |calm: Option<f32>| {
        median_angle(&run(&points, |p| sphere(p) + 0.05, &MeshingParams { calm, ..params() }).mesh, sphere)
    };
    let (rough, calm) = (angle(None), angle(Some(0.15)));
    assert!(calm < 0.95 * rough, "{calm} of {rough} degrees");

    let cube = |p: Vec3| 0.4 - p.abs().max_element();
    let at = |sigma: f32| {
        let points: Vec<Point> = cloud(cube, 1.5, |_| true).into_iter().map(|p| Point { sigma, ..p }).collect();
        error(&run(&points, |p| cube(p) + 0.05, &params()).mesh, cube, 0.99)
    };
    let (precise, imprecise) = (at(0.03), at(1.0));
    assert!(precise < 0.95 * imprecise, "{precise} of {imprecise} voxels");
}

#[test]
fn uneven_sampling_does_not_move_the_surface() {
    // Strips of the full density, one eighth of it between them.
    let mut random = Random::new(29);
    let mut points = cloud(sphere, 3.0, |_| true);
    points.retain(|p| (p.position.z * 20.0).sin() > 0.7 || random.below(8) == 0);
    let mesh = run(&points, |p| sphere(p) + 0.05, &params()).mesh;
    assert!(error(&mesh, sphere, 0.9) < 0.15, "{}", error(&mesh, sphere, 0.9));
}

#[test]
fn holes_are_closed() {
    // A quarter of the diameter without any point.
    let cap = |p: Vec3| p.x > 0.4 && p.y.abs() < 0.13 && p.z.abs() < 0.13;
    let points = cloud(sphere, 1.5, |p| !cap(p));
    let meshed = run(&points, |p| sphere(p) + 0.05, &params());
    assert!(error(&meshed.mesh, sphere, 1.0) < 5.0);
    assert!(meshed.mesh.positions.iter().any(|&p| cap(p * (0.5 / p.length()))));
}

#[test]
fn thin_parts_survive_and_stay_apart() {
    let points = cloud(fingers, 1.5, |_| true);
    let mut mesh = run(&points, |p| fingers(p) + VOXEL, &params()).mesh;
    assert!(error(&mesh, fingers, 0.9) < 0.15, "{}", error(&mesh, fingers, 0.9));
    // A threshold above the largest share drops all but the largest: four parts, none joined, none torn.
    assert_eq!(drop_small_components(&mut mesh, 1.0, &mut Workspace::default()), 3);
}

#[test]
fn nothing_lies_outside_the_envelope() {
    let points = cloud(sphere, 1.5, |_| true);
    let cut = |p: Vec3| sphere(p).min(0.3 - p.z).min(0.35 - p.x);
    for (constraint, allowed) in [(SpaceConstraint::Envelope, 0.5), (SpaceConstraint::Rectify, 1.0)] {
        let params = MeshingParams { space_constraint: Some(constraint), ..params() };
        let mesh = run(&points, cut, &params).mesh;
        let farthest = quantile(mesh.positions.iter().map(|&p| -cut(p) / VOXEL), 1.0);
        assert!(farthest < allowed, "{farthest}");
        // It is not merely shrunk: the envelope's faces are reached.
        assert!(mesh.positions.iter().any(|p| p.z > 0.3 - VOXEL && p.x.abs() < 0.2 && p.y.abs() < 0.2));
    }
    let free = MeshingParams { space_constraint: None, ..params() };
    assert!(run(&points, cut, &free).mesh.positions.iter().any(|p| p.z > 0.45));
}

#[test]
fn weights_draw_the_surface() {
    // Two shells, one voxel apart, that contradict each other.
    let shells = |inner: f32, outer: f32| -> Vec<Point> {
        let shell = |radius: f32, weight: f32| {
            cloud(sphere, 1.0, |_| true).into_iter().map(move |p| point(p.normal * radius, p.normal, weight))
        };
        shell(0.4, inner).chain(shell(0.4 + VOXEL, outer)).collect()
    };
    for screening in [None, Some(4.0)] {
        let radius = |inner: f32, outer: f32| {
            let mesh = run(&shells(inner, outer), |p| sphere(p) + 0.05, &MeshingParams { screening, ..params() }).mesh;
            (quantile(mesh.positions.iter().map(|p| p.length()), 0.5) - 0.4) / VOXEL
        };
        let (low, even, high) = (radius(4.0, 1.0), radius(1.0, 1.0), radius(1.0, 4.0));
        assert!(low < even - 0.15 && even + 0.15 < high, "{low} {even} {high}");
        assert!((0.0..1.0).contains(&low) && (0.0..1.0).contains(&high), "{low} {high}");
    }
}

#[test]
fn the_order_of_the_points_does_not_matter() {
    let mut points = cloud(torus, 1.0, |_| true);
    let first = run(&points, torus, &params());
    points.reverse();
    points.rotate_left(777);
    assert_eq!(first.mesh, run(&points, torus, &params()).mesh);
}

#[test]
fn small_components_and_cavities_are_dropped() {
    let solid: Solid = |p| {
        let hollow = sphere(p).min((p - Vec3::X * 0.2).length() - 0.1);
        hollow.max(0.07 - (p - Vec3::splat(0.45)).length())
    };
    let points = cloud(solid, 1.5, |_| true);
    let meshed = run(&points, |p| sphere(p).max(0.1 - (p - Vec3::splat(0.45)).length()), &params());
    assert_eq!(meshed.components_dropped, 2);
    assert!(error(&meshed.mesh, sphere, 0.9) < 0.1);
}

#[test]
fn without_points_there_is_no_surface() {
    let none = mesh(Vec::new().into(), &Hull(sphere), VOXEL, &params(), &mut Workspace::default(), &Serial, &Silent);
    assert_eq!(none.unwrap_err(), Error::NoSurface);
    let weightless: Vec<Point> =
        cloud(sphere, 0.5, |_| true).into_iter().map(|p| point(p.position, p.normal, 0.0)).collect();
    assert_eq!(
        mesh((&weightless).into(), &Hull(sphere), VOXEL, &params(), &mut Workspace::default(), &Serial, &Silent)
            .unwrap_err(),
        Error::NoSurface
    );
}

/// Refuses the step of a given number.
struct Refusal {
    at: u32,
    steps: AtomicU32,
    last: AtomicU32,
}

impl Progress for Refusal {
    fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
        assert_eq!(stage, Stage::Mesh);
        assert!(done <= total && self.last.swap(done, Ordering::Relaxed) <= done);
        self.steps.fetch_add(1, Ordering::Relaxed) + 1 != self.at
    }
}

#[test]
fn every_step_can_cancel() {
    let points = cloud(sphere, 0.5, |_| true);
    let attempt = |at: u32| {
        let refusal = Refusal { at, steps: AtomicU32::new(0), last: AtomicU32::new(0) };
        let result =
            mesh((&points).into(), &Hull(sphere), 2.0 * VOXEL, &params(), &mut Workspace::default(), &Serial, &refusal);
        (result, refusal.steps.into_inner())
    };
    let (complete, steps) = attempt(0);
    assert!(complete.is_ok());
    for at in 1..=steps {
        let (result, seen) = attempt(at);
        assert_eq!(result.unwrap_err(), Error::Cancelled);
        assert_eq!(seen, at);
    }
}
