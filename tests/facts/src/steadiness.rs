//! How steady the meshes of a take are, at material points of the figure, whose motion is known.

use crate::{Shot, topology::assert_sound};
use glam::DVec3;
use libm::sqrt;
use pcmvs_core::{
    Mesh, Params, Preset, Silent,
    steady::{SteadyParams, steady},
};
use pcmvs_scene::Threads;
use std::ops::Range;
use studio::{Capture, Faults, Ring, Subject, TriangleMesh, score};

/// Frames per second.
const RATE: f64 = 30.0;
/// Points on the surface of the first frame.
const POINTS: usize = 4000;
/// Largest distance of a mesh that is measured, in footprints.
const FAR: f64 = 3.0;

/// The figure, whose legs are at rest while the rest of it moves, with noise of 4 grey levels and contours that are off by
/// 0.7 pixels.
pub fn take_of_figure(frames: usize, views: u32, (width, height): (u32, u32)) -> Vec<Shot> {
    let cameras = Ring { count: views, ..Ring::default() }.sized(width, height).cameras();
    let faults = Faults { noise: 4.0, contour_error: 0.7, ..Faults::default() };
    let times: Vec<f64> = (0..frames).map(|frame| frame as f64 / RATE).collect();
    let Capture { cameras, frames, .. } = Capture::new(Subject::Standing, &cameras, &times, &faults);
    frames.into_iter().map(|frame| Shot { cameras: cameras.clone(), frame }).collect()
}

/// Reconstructs every frame by itself, and averages each with those before and after it.
pub fn alone_and_averaged(shots: &[Shot], threads: &Threads) -> [Vec<Mesh>; 2] {
    let params = Params::preset(Preset::Default);
    let make = |shot: &Shot| {
        let made = shot.reconstruct_with(&params, threads, &Silent).expect("the studio's frames are sound");
        (made.mesh, made.footprint)
    };
    let (alone, footprints): (Vec<Mesh>, Vec<f32>) = shots.iter().map(make).unzip();
    let average = |i: usize| {
        let near = i.saturating_sub(1)..(i + 2).min(alone.len());
        let neighbours: Vec<&Mesh> = near.filter(|&other| other != i).map(|other| &alone[other]).collect();
        let mut mean = alone[i].clone();
        steady(&mut mean, &neighbours, footprints[i], &SteadyParams::DEFAULT, threads, &Silent)
            .expect("nothing cancels it");
        assert_sound(&mean, "averaged");
        assert!(mean.triangles == alone[i].triangles);
        mean
    };
    let averaged = (0..alone.len()).map(average).collect();
    [alone, averaged]
}

/// What the meshes of a take are like at a point of the figure that all frames see.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    /// Speed in footprints per frame.
    pub speed: f64,
    /// Standard deviation over the frames of the distance of the mesh from the point, in footprints.
    pub jitter: f64,
    /// Mean over the frames of its magnitude.
    pub error: f64,
    /// Standard deviation over the frames of the luma of the mesh's colour, in grey levels.
    pub flicker: f64,
}

/// Measures the meshes of a take.
pub fn measure(shots: &[Shot], meshes: &[Mesh]) -> Vec<Point> {
    let footprint = shots[0].footprint(shots[0].rig().origin());
    let world: Vec<TriangleMesh> = shots.iter().zip(meshes).map(|(shot, mesh)| shot.in_world(mesh)).collect();
    let grids: Vec<score::TriangleGrid> =
        world.iter().map(|mesh| score::TriangleGrid::new(mesh, FAR * footprint)).collect();
    let of = |p: DVec3| -> Option<Point> {
        let material = shots[0].truth().material(p)?;
        let places: Vec<(DVec3, DVec3)> = shots
            .iter()
            .map(|shot| {
                let p = shot.truth().place(material);
                (p, shot.truth().normal(p))
            })
            .collect();
        if !shots.iter().zip(&places).all(is_seen) {
            return None;
        }
        let hits: Vec<(f64, usize)> =
            grids.iter().zip(&places).map(|(grid, &(p, n))| grid.along(p, n)).collect::<Option<_>>()?;
        let distances: Vec<f64> = hits.iter().map(|&(distance, _)| distance).collect();
        let lumas: Vec<f64> = hits
            .iter()
            .enumerate()
            .map(|(i, &(distance, face))| luma(&meshes[i], &world[i], face, places[i].0 + places[i].1 * distance))
            .collect();
        let way: f64 = places.windows(2).map(|pair| (pair[1].0 - pair[0].0).length()).sum();
        Some(Point {
            speed: way / (places.len() - 1) as f64 / footprint,
            jitter: deviation(&distances) / footprint,
            error: distances.iter().map(|d| d.abs()).sum::<f64>() / distances.len() as f64 / footprint,
            flicker: deviation(&lumas),
        })
    };
    shots[0].truth().surface_points(POINTS, 0).into_iter().filter_map(|(p, _)| of(p)).collect()
}

/// Whether two cameras see a point of the surface, and no other part covers it.
fn is_seen((shot, &(p, n)): (&Shot, &(DVec3, DVec3))) -> bool {
    let seeing = shot.cameras.iter().filter(|camera| score::sees(shot.truth(), camera, p, n));
    shot.truth().distance(p).abs() < 1e-4 && seeing.take(2).count() == 2
}

/// The luma (BT.601) of a mesh's colour at a place in one of its triangles, interpolated between the corners.
fn luma(mesh: &Mesh, world: &TriangleMesh, face: usize, p: DVec3) -> f64 {
    let [a, b, c] = world.corners(face);
    let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).length();
    let weights = [area(p, b, c), area(a, p, c), area(a, b, p)];
    let total: f64 = weights.iter().sum();
    let of = |[r, g, b]: [u8; 3]| 0.299 * f64::from(r) + 0.587 * f64::from(g) + 0.114 * f64::from(b);
    mesh.triangles[face].iter().zip(weights).map(|(&v, w)| w / total * of(mesh.colours[v as usize])).sum()
}

/// The standard deviation of some values.
fn deviation(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    sqrt(values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count)
}

/// The points whose speed lies in a range.
pub fn of_speed(points: &[Point], speed: &Range<f64>) -> Vec<Point> {
    points.iter().filter(|point| speed.contains(&point.speed)).copied().collect()
}

/// The value of some points that a share of them does not exceed.
pub fn quantile(points: &[Point], share: f64, value: impl Fn(&Point) -> f64) -> f64 {
    let mut values: Vec<f64> = points.iter().map(value).collect();
    values.sort_by(f64::total_cmp);
    values[((values.len() - 1) as f64 * share) as usize]
}
