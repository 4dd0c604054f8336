//! §4.3: each of the three constraints, on points built so that it is known which of them go.

use super::super::{
    clean::{CleanParams, CleanScratch, clean},
    depth::DepthMap,
    level::PyramidLevel,
};
use crate::{
    point_cloud::{PointCloud, Rank},
    report::Counts,
    testing::pinhole,
};
use alloc::{collections::BTreeSet, vec, vec::Vec};
use glam::{DVec3, Vec3};
use nalgebra::{Matrix3, SymmetricEigen};
use studio::noise::Random;

const SIZE: usize = 48;
/// All constraints off.
const OFF: CleanParams = CleanParams { radius_pixels: 2.5, density: None, flatness: None, facing: None };

type Pixels = BTreeSet<(usize, usize)>;

/// A view at the origin of the z axis that looks along it, with square pixels.
fn level() -> PyramidLevel<'static> {
    PyramidLevel {
        camera: pinhole(Vec3::ZERO, Vec3::Z, SIZE as u32, 60.0),
        luma: vec![0; SIZE * SIZE].into(),
        inside: vec![64; SIZE * SIZE].into(),
    }
}

/// Depths pixel by pixel; fidelity 1 where there is one.
fn map(depth: impl Fn(usize, usize) -> Option<f32>) -> DepthMap {
    let depth: Vec<f32> = (0..SIZE * SIZE).map(|i| depth(i % SIZE, i / SIZE).unwrap_or(0.0)).collect();
    let fidelity = depth.iter().map(|&d| if d > 0.0 { 1.0 } else { 0.0 }).collect();
    let sigma = vec![0.0; SIZE * SIZE];
    DepthMap { depth, fidelity, sigma, ..DepthMap::default() }
}

fn run(map: &DepthMap, params: &CleanParams) -> (PointCloud, Counts) {
    let mut counts = Counts::default();
    let rank = vec![Rank::Detected; SIZE * SIZE];
    let cloud = clean(&level(), map, &rank, 3, params, 1.0, &mut CleanScratch::default(), &mut counts);
    (cloud, counts)
}

/// Pixels of a depth map whose points are not in a cloud.
fn gone(map: &DepthMap, cloud: &PointCloud) -> Pixels {
    let camera = level().camera;
    let mut gone: Pixels = (0..SIZE * SIZE).filter(|&i| map.depth[i] > 0.0).map(|i| (i % SIZE, i / SIZE)).collect();
    for p in cloud {
        let q = camera.project(p.position);
        let pixel = (libm::roundf(q.x) as usize, libm::roundf(q.y) as usize);
        assert!(gone.remove(&pixel), "a point that was not there, or twice, at {pixel:?}");
    }
    gone
}

/// A plane that faces the camera: a square of 24 x 24 pixels with 21 neighbours (itself among them) to each inner point,
/// 13 at its edges and 8 at its corners, and apart from it a line one pixel wide, with 5.
#[test]
fn density_points_with_fewer_than_half_the_average_number_of_neighbours_go() {
    let square = |x: usize, y: usize| (4..28).contains(&x) && (4..28).contains(&y);
    let line = |x: usize, y: usize| x == 40 && (10..30).contains(&y);
    // Four points in the square's middle are nearer to the camera: they have neighbours in the picture, not in space.
    let near = |x: usize, y: usize| (15..17).contains(&x) && (15..17).contains(&y);
    let map = map(|x, y| if near(x, y) { Some(1.5) } else { (square(x, y) || line(x, y)).then_some(2.0) });
    let (cloud, counts) = run(&map, &CleanParams { density: Some(0.5), ..OFF });
    let corners = [(4, 4), (27, 4), (4, 27), (27, 27)];
    let near = [(15, 15), (16, 15), (15, 16), (16, 16)];
    let expected: Pixels = corners.into_iter().chain(near).chain((10..30).map(|y| (40, y))).collect();
    assert_eq!(gone(&map, &cloud), expected);
    assert_eq!((counts.cleaned_density, counts.cleaned_pca, counts.cleaned_normal), (28, 0, 0));
    // It is the average that counts: of a cloud that is thin everywhere most stays.
    let thin = self::map(|x, y| (x % 6 == 0 && x > 0).then_some(2.0).filter(|_| (4..44).contains(&y)));
    let (cloud, _) = run(&thin, &CleanParams { density: Some(0.5), ..OFF });
    let ends: Pixels = gone(&thin, &cloud);
    assert!(ends.is_empty() || ends.iter().all(|&(_, y)| y == 4 || y == 43), "{ends:?}");
}

/// The standard deviation of a point is the distance along its normal by which an error of its depth moves it. In the
/// corners of the picture rays are longer, and the same error moves a point farther.
#[test]
fn an_error_of_the_depth_moves_a_point_along_its_ray() {
    const ERROR: f32 = 0.05;
    let camera = level().camera;
    let slope = |x: usize, y: usize| Some(1.0 / (0.5 + 0.002 * x as f32 - 0.001 * y as f32));
    let (cloud, _) = run(&DepthMap { sigma: vec![ERROR; SIZE * SIZE], ..map(slope) }, &OFF);
    assert_eq!(cloud.len(), SIZE * SIZE);
    for p in &cloud {
        let pixel = camera.project(p.position);
        let moved = camera.unproject(pixel.x, pixel.y, pixel.z + ERROR) - p.position;
        let expected = moved.dot(p.normal).abs();
        assert!((p.sigma - expected).abs() < 1e-4, "{} instead of {expected} at {pixel}", p.sigma);
    }
}

/// Share by which a neighbourhood is not flat: λ3/λ2, of points within a radius, in double precision. `None` if it has
/// fewer than four points or its radius passes through a point.
fn flatness(map: &DepthMap, x: usize, y: usize) -> Option<f64> {
    let camera = level().camera;
    let at = |x: usize, y: usize| {
        let depth = map.depth[y * SIZE + x];
        (depth > 0.0).then(|| camera.unproject(x as f32, y as f32, depth).as_dvec3())
    };
    let centre = at(x, y)?;
    let radius = f64::from(OFF.radius_pixels) * centre.z / 60.0;
    let all = (0..SIZE * SIZE).filter_map(|i| at(i % SIZE, i / SIZE));
    if all.clone().any(|p| ((p - centre).length() / radius - 1.0).abs() < 1e-4) {
        return None;
    }
    let near: Vec<DVec3> = all.filter(|p| (*p - centre).length() <= radius).collect();
    if near.len() < 4 {
        return None;
    }
    let mean = near.iter().sum::<DVec3>() / near.len() as f64;
    let covariance = near.iter().fold(Matrix3::zeros(), |sum, p| {
        let d = nalgebra::Vector3::from((*p - mean).to_array());
        sum + d * d.transpose() / near.len() as f64
    });
    let mut values: Vec<f64> = SymmetricEigen::new(covariance).eigenvalues.iter().copied().collect();
    values.sort_by(f64::total_cmp);
    Some(values[0] / values[1])
}

/// Left a plane, in the middle points that scatter in depth by as much as a neighbourhood is wide, right a thread that
/// is as thick as it is deep. The plane stays and what nalgebra calls round goes.
#[test]
fn pca_points_in_neighbourhoods_that_are_not_flat_go() {
    let mut random = Random::new(3, 0);
    let scatter: Vec<f32> = (0..SIZE * SIZE).map(|_| random.signed() as f32).collect();
    let footprint = 2.0 / 60.0;
    let map = map(|x, y| match x {
        2..16 => Some(2.0 + 0.5 * footprint * x as f32),
        18..34 => Some(2.0 + 1.6 * footprint * scatter[y * SIZE + x]),
        40..42 => Some(2.0 + footprint * if (x + y / 2) % 2 == 0 { 0.5 } else { -0.5 }),
        _ => None,
    });
    let (cloud, counts) = run(&map, &CleanParams { flatness: Some(0.5), ..OFF });
    let gone = gone(&map, &cloud);
    let (mut round, mut flat) = ([0; 3], [0; 3]);
    for (x, y) in (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE)) {
        let Some(ratio) = flatness(&map, x, y) else { continue };
        if (ratio - 0.5).abs() > 1e-3 {
            assert_eq!(gone.contains(&(x, y)), ratio > 0.5, "({x}, {y}): λ3/λ2 is {ratio}");
            let part = if x < 17 { 0 } else { if x < 37 { 1 } else { 2 } };
            if ratio > 0.5 { round[part] += 1 } else { flat[part] += 1 }
        }
    }
    // What is in which part: the plane is flat, the thread is round and the rest is both.
    assert!(round[0] == 0 && flat[0] > 500, "{round:?} {flat:?}");
    assert!(round[1] > 100 && flat[1] > 100, "{round:?} {flat:?}");
    assert!(round[2] > 40, "{round:?} {flat:?}");
    // A few of the scattered points have too few neighbours for a plane, with or without the constraint.
    let without = run(&map, &OFF).1;
    assert!(counts.cleaned_density == without.cleaned_density && counts.cleaned_density < 10, "{counts:?}");
    assert_eq!((counts.cleaned_normal, without.cleaned_pca), (0, 0));
}

/// A plane that turns away: exactly the points that the camera sees at a grazing angle go.
#[test]
fn normal_points_seen_at_a_grazing_angle_go() {
    const LEAST: f32 = 0.6;
    for turn in [0.0f32, 1.3, 4.0] {
        let (sin, cos) = libm::sincosf(42f32.to_radians());
        let (across, up) = libm::sincosf(turn);
        let normal = Vec3::new(sin * up, sin * across, -cos);
        let (level, place) = (level(), Vec3::Z * 2.0);
        let map = map(|x, y| Some(place.dot(normal) / level.camera.ray(x as f32, y as f32).dot(normal)));
        let (cloud, counts) = run(&map, &CleanParams { facing: Some(LEAST), ..OFF });
        let gone = gone(&map, &cloud);
        let mut expected = 0;
        for (x, y) in (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE)) {
            let facing = -level.camera.ray(x as f32, y as f32).normalize().dot(normal);
            expected += u32::from(facing < LEAST);
            if (facing - LEAST).abs() > 1e-3 {
                assert_eq!(gone.contains(&(x, y)), facing < LEAST, "turn {turn}, ({x}, {y}): n·c is {facing}");
            }
        }
        assert!((100..SIZE as u32 * 40).contains(&expected), "{expected}");
        // Where the plane is steepest a few of its corners have no normal.
        assert!(
            counts.cleaned_normal.abs_diff(expected) < 20 && counts.cleaned_density < 20 && counts.cleaned_pca == 0
        );
        // What stays has the plane's normal, on the camera's side.
        assert!(cloud.iter().all(|p| p.normal.dot(normal) > 0.999 && p.view == 3));
    }
}
