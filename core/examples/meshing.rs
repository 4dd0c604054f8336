//! Meshes 200,000 points on a torus of radii 0.38 and 0.15 with nodes as far apart as other solvers have them at depth 8.
//! Writes the points to the PLY file named, for other programs, and prints seconds (the fastest of three), the number of
//! vertices, and their mean and 99 % error in thousandths.
#![allow(clippy::disallowed_methods, reason = "no result depends on the example's own numbers")]

use glam::Vec3;
use pcmvs_core::{Params, Point, Preset, Rank, Silent, mesh};
use std::{fmt::Write as _, time::Instant};

const POINTS: usize = 200_000;
const RADII: (f32, f32) = (0.38, 0.15);
/// 256 nodes over 1.1 times the extent.
const VOXEL: f32 = 1.06 * 1.1 / 256.0;

/// Nothing is outside.
struct Anywhere;

impl mesh::Envelope for Anywhere {
    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::splat(-0.55), Vec3::splat(0.55))
    }

    fn signed_distance(&self, _: Vec3) -> f32 {
        1.0
    }
}

/// Evenly distributed points, from a sequence of low discrepancy.
fn points() -> Vec<Point> {
    let mut points = Vec::with_capacity(POINTS);
    let mut i = 0.0_f64;
    while points.len() < POINTS {
        i += 1.0;
        let [u, v, keep] = [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_902].map(|a| (i * a).fract() as f32);
        let (a, b) = (u * core::f32::consts::TAU, v * core::f32::consts::TAU);
        let distance = RADII.0 + RADII.1 * b.cos();
        // The outer side has more surface.
        if keep * (RADII.0 + RADII.1) < distance {
            let normal = Vec3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin());
            let position = Vec3::new(a.cos() * distance, a.sin() * distance, b.sin() * RADII.1);
            points.push(Point { position, normal, fidelity: 1.0, weight: 1.0, view: 0, rank: Rank::Detected });
        }
    }
    points
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let points = points();
    if let Some(path) = std::env::args().nth(1) {
        let mut ply = format!("ply\nformat ascii 1.0\nelement vertex {POINTS}\n");
        for name in ["x", "y", "z", "nx", "ny", "nz"] {
            writeln!(ply, "property float {name}")?;
        }
        ply += "end_header\n";
        for Point { position: p, normal: n, .. } in &points {
            writeln!(ply, "{} {} {} {} {} {}", p.x, p.y, p.z, n.x, n.y, n.z)?;
        }
        std::fs::write(path, ply)?;
    }
    let params = Params::preset(Preset::Default).meshing;
    let (mut seconds, mut positions) = (f64::INFINITY, Vec::new());
    for _ in 0..3 {
        let start = Instant::now();
        positions = mesh::mesh(&points, &Anywhere, VOXEL, &params, &Silent)?.mesh.positions;
        seconds = seconds.min(start.elapsed().as_secs_f64());
    }
    let error = |p: &Vec3| (RADII.1 - (p.truncate().length() - RADII.0).hypot(p.z)).abs();
    let mut errors: Vec<f32> = positions.iter().map(error).collect();
    errors.sort_by(f32::total_cmp);
    let mean = errors.iter().sum::<f32>() / errors.len() as f32;
    println!("{seconds} {} {} {}", errors.len(), mean * 1e3, errors[errors.len() * 99 / 100] * 1e3);
    Ok(())
}
