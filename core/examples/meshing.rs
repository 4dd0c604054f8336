//! Meshes 200,000 points on a torus with radii 0.38 and 0.15, at the node spacing that other solvers have at depth 8.
//! The first cloud is exact. The second one has noise like a measurement: standard deviations of half a voxel along each
//! axis, and of 10 degrees for normals.
//!
//! Prints one line per cloud: name, seconds (the fastest of three runs), number of vertices, and their mean and
//! 99th-percentile error in thousandths. If a folder is given, the clouds are written there as PLY for other programs.
#![allow(clippy::disallowed_methods, reason = "the example's own numbers need not be deterministic")]

use glam::Vec3;
use pcmvs_core::{Params, Point, Preset, Rank, Serial, Silent, Workspace, mesh, surface};
use std::{fmt::Write as _, path::Path, time::Instant};
use studio::noise::Random;

const POINTS: usize = 200_000;
const RADII: (f32, f32) = (0.38, 0.15);
/// Spacing of 256 nodes over 1.1 times the extent.
const VOXEL: f32 = 1.06 * 1.1 / 256.0;
/// Standard deviations of the noisy cloud: of each coordinate, and of the angle of normals in degrees.
const NOISE: (f32, f32) = (0.5 * VOXEL, 10.0);

/// An envelope that contains all of space.
struct Anywhere;

impl surface::Envelope for Anywhere {
    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::splat(-0.55), Vec3::splat(0.55))
    }

    fn signed_distance(&self, _: Vec3) -> f32 {
        1.0
    }
}

/// Evenly distributed points, from a low-discrepancy sequence (R3 of Roberts, 2018).
fn exact() -> Vec<Point> {
    let mut points = Vec::with_capacity(POINTS);
    let mut i = 0.0_f64;
    while points.len() < POINTS {
        i += 1.0;
        let [u, v, keep] = [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_902].map(|a| (i * a).fract() as f32);
        let (a, b) = (u * core::f32::consts::TAU, v * core::f32::consts::TAU);
        let distance = RADII.0 + RADII.1 * b.cos();
        // Rejection sampling, because the outer side has more surface.
        if keep * (RADII.0 + RADII.1) < distance {
            let normal = Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin());
            let position = Vec3::new(a.cos() * distance, a.sin() * distance, b.sin() * RADII.1);
            points.push(Point {
                position,
                normal,
                fidelity: 1.0,
                sigma: 0.0,
                weight: 1.0,
                view: 0,
                rank: Rank::Detected,
            });
        }
    }
    points
}

/// The same points with noise like that of a measurement.
fn noisy(mut points: Vec<Point>) -> Vec<Point> {
    let mut random = Random::new(1, 0);
    for point in &mut points {
        let mut normal = || random.normal() as f32;
        point.position += Vec3::new(normal(), normal(), normal()) * NOISE.0;
        let direction = Vec3::new(normal(), normal(), normal());
        let tangent = direction.reject_from_normalized(point.normal).normalize();
        let angle = (normal() * NOISE.1).to_radians();
        point.normal = point.normal * angle.cos() + tangent * angle.sin();
    }
    points
}

fn write_ply(path: &Path, points: &[Point]) -> Result<(), Box<dyn std::error::Error>> {
    let mut ply = format!("ply\nformat ascii 1.0\nelement vertex {}\n", points.len());
    for name in ["x", "y", "z", "nx", "ny", "nz"] {
        writeln!(ply, "property float {name}")?;
    }
    ply += "end_header\n";
    for Point { position: p, normal: n, .. } in points {
        writeln!(ply, "{} {} {} {} {} {}", p.x, p.y, p.z, n.x, n.y, n.z)?;
    }
    Ok(std::fs::write(path, ply)?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let params = Params::preset(Preset::Default).meshing;
    for (name, points) in [("exact", exact()), ("noisy", noisy(exact()))] {
        if let Some(folder) = std::env::args().nth(1) {
            write_ply(&Path::new(&folder).join(format!("torus-{name}.ply")), &points)?;
        }
        let (mut seconds, mut positions) = (f64::INFINITY, Vec::new());
        for _ in 0..3 {
            let start = Instant::now();
            positions =
                mesh::mesh((&points).into(), &Anywhere, VOXEL, &params, &mut Workspace::default(), &Serial, &Silent)?
                    .mesh
                    .positions;
            seconds = seconds.min(start.elapsed().as_secs_f64());
        }
        let error = |p: &Vec3| (RADII.1 - (p.truncate().length() - RADII.0).hypot(p.z)).abs();
        let mut errors: Vec<f32> = positions.iter().map(error).collect();
        errors.sort_by(f32::total_cmp);
        let mean = errors.iter().sum::<f32>() / errors.len() as f32;
        println!("{name} {seconds} {} {} {}", errors.len(), mean * 1e3, errors[errors.len() * 99 / 100] * 1e3);
    }
    Ok(())
}
