//! Facts of the mean with neighbouring frames, on a patterned ellipsoid whose true surface is known.

use super::{SteadyParams, steady};
use crate::{
    error::Error,
    executor::{Executor, Serial},
    point_cloud::Mesh,
    progress::{Progress, Silent},
    stage::Stage,
    testing::sphere,
};
use alloc::vec::Vec;
use glam::{Mat3, Quat, Vec3};

/// Half axes in pixels of footprint, and the footprint in scene units.
const AXES: Vec3 = Vec3::new(30.0, 40.0, 50.0);
const FOOTPRINT: f32 = 0.003;

/// Numbers from -1 to 1 that look random.
fn noise(seed: u32, i: usize) -> f32 {
    let mut x = (i as u32).wrapping_mul(0x9e37_79b9) ^ seed.wrapping_mul(0x85eb_ca6b);
    x = (x ^ x >> 15).wrapping_mul(0x2c1b_3c6d);
    x = (x ^ x >> 12).wrapping_mul(0x297a_2d39);
    (x ^ x >> 15) as f32 / u32::MAX as f32 * 2.0 - 1.0
}

/// The colour of a material point, given by its direction from the centre.
fn pattern(p: Vec3) -> Vec3 {
    let wave = |t: f32| 50.0 * libm::sinf(t);
    Vec3::new(120.0 + wave(9.0 * p.x + 2.0 * p.y), 130.0 + wave(8.0 * p.y - 3.0 * p.z), 110.0 + wave(10.0 * p.z))
}

/// A rigid motion.
#[derive(Clone, Copy)]
struct Pose {
    turn: f32,
    /// In pixels.
    shift: Vec3,
}

const REST: Pose = Pose { turn: 0.0, shift: Vec3::ZERO };

impl Pose {
    fn rotation(self) -> Mat3 {
        Mat3::from_quat(Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), self.turn))
    }

    /// Distance of a point from the ellipsoid's surface in pixels, positive outside, to first order.
    fn distance(self, p: Vec3) -> f32 {
        let q = self.rotation().transpose() * (p / FOOTPRINT - self.shift);
        let level = (q / AXES).length() - 1.0;
        level * (q / AXES).length() / (q / (AXES * AXES)).length()
    }
}

/// The ellipsoid as a frame shows it: noise of up to `amount` pixels along the normal, and of 10 grey levels per pixel of it.
fn frame(pose: Pose, seed: u32, amount: f32) -> Mesh {
    let unit = sphere(Vec3::ZERO, 1.0);
    let mut mesh = Mesh { triangles: unit.triangles, ..Mesh::default() };
    for (i, &p) in unit.positions.iter().enumerate() {
        let normal = (p / AXES).normalize();
        let place = p * AXES + normal * (amount * noise(seed, i));
        mesh.positions.push((pose.rotation() * place + pose.shift) * FOOTPRINT);
        mesh.normals.push(pose.rotation() * normal);
        let colour = pattern(p) + 10.0 * amount * noise(seed + 100, i);
        mesh.colours.push(colour.to_array().map(|c| c as u8));
    }
    mesh
}

fn root_mean_square(values: impl ExactSizeIterator<Item = f32>) -> f32 {
    let count = values.len() as f32;
    libm::sqrtf(values.map(|v| v * v).sum::<f32>() / count)
}

/// Root mean square error of a mesh, in pixels.
fn error(mesh: &Mesh, pose: Pose) -> f32 {
    root_mean_square(mesh.positions.iter().map(|&p| pose.distance(p)))
}

/// Root mean square error of the red channel in grey levels.
fn colour_error(mesh: &Mesh) -> f32 {
    let unit = sphere(Vec3::ZERO, 1.0);
    root_mean_square(mesh.colours.iter().zip(&unit.positions).map(|(c, &p)| f32::from(c[0]) + 0.5 - pattern(p).x))
}

fn averaged(mesh: &Mesh, neighbours: &[&Mesh]) -> Mesh {
    let mut mesh = mesh.clone();
    steady(&mut mesh, neighbours, FOOTPRINT, &SteadyParams::DEFAULT, &Serial, &Silent).expect("nothing cancels it");
    mesh
}

/// Poses of the frame before and after a frame at rest.
const MOVING: [Pose; 2] =
    [Pose { turn: -0.08, shift: Vec3::new(-9.0, 4.0, 1.0) }, Pose { turn: 0.08, shift: Vec3::new(9.0, -3.0, 2.0) }];

#[test]
fn noise_falls_whether_the_subject_moves_or_not() {
    let own = frame(REST, 0, 0.25);
    for poses in [[REST; 2], MOVING] {
        let [before, after] = [0, 1].map(|k| frame(poses[k], k as u32 + 1, 0.25));
        let mean = averaged(&own, &[&before, &after]);
        // The binomial filter of independent errors leaves √(1/4 + 1/16 + 1/16) = 0.61, and equal weights, as colours have,
        // leave √(1/3) = 0.58. Neighbours count a little less where they differ.
        let (left, colours_left) = (error(&mean, REST) / error(&own, REST), colour_error(&mean) / colour_error(&own));
        assert!(left < 0.68, "{left}");
        assert!(colours_left < 0.62, "{colours_left}");
        assert!(mean.triangles == own.triangles);
    }
}

#[test]
fn a_moving_surface_is_not_dragged() {
    // Without noise nothing may change, however the neighbours have moved.
    let own = frame(REST, 0, 0.0);
    let [before, after] = MOVING.map(|pose| frame(pose, 0, 0.0));
    let mean = averaged(&own, &[&before, &after]);
    let (moved, changed) = (error(&mean, REST), colour_error(&mean));
    assert!(moved < 0.02, "{moved}");
    assert!(changed < 1.0, "{changed}");
}

#[test]
fn a_subject_at_rest_is_averaged_as_a_whole() {
    // The neighbours see the whole subject shifted by a few hundredths of a pixel, as errors of contours do.
    let shifted = |x: f32| Pose { turn: 0.0, shift: Vec3::new(x, 0.0, 0.0) };
    let own = frame(shifted(0.04), 0, 0.0);
    let other = frame(shifted(-0.04), 0, 0.0);
    let mean = averaged(&own, &[&other, &other]);
    assert!(error(&mean, REST) < 0.3 * error(&own, REST), "{}", error(&mean, REST));
}

#[test]
fn what_is_not_the_same_is_left_alone() {
    let own = frame(REST, 0, 0.2);
    // Too far away to be found.
    let far = frame(Pose { turn: 0.0, shift: Vec3::new(500.0, 0.0, 0.0) }, 1, 0.2);
    assert_eq!(averaged(&own, &[&far]).hash(), own.hash());
    assert_eq!(averaged(&own, &[]).hash(), own.hash());
    // Of another colour: the surface is averaged, and colours stay.
    let mut other = frame(REST, 1, 0.2);
    other.colours.iter_mut().for_each(|c| *c = [c[0] / 4, 255, c[2] / 4]);
    let mean = averaged(&own, &[&other]);
    assert!(mean.colours == own.colours);
    assert!(error(&mean, REST) < error(&own, REST));
    // A part that the neighbour lacks.
    let mut half = frame(REST, 1, 0.2);
    let is_low = |v: u32, mesh: &Mesh| mesh.positions[v as usize].z < 0.0;
    half.triangles = half.triangles.iter().copied().filter(|t| t.iter().all(|&v| is_low(v, &half))).collect();
    half.positions.iter_mut().filter(|p| p.z >= 0.0).for_each(|p| *p = Vec3::splat(10.0));
    let mean = averaged(&own, &[&half]);
    let top = |mesh: &Mesh| -> Vec<Vec3> { mesh.positions.iter().copied().filter(|p| p.z > 0.02).collect() };
    assert!(top(&mean) == top(&own));
}

/// Runs the jobs of each call from the last to the first.
struct Backwards;

impl Executor for Backwards {
    fn run(&self, count: usize, job: &(dyn Fn(usize) + Sync)) {
        (0..count).rev().for_each(job);
    }
}

#[test]
fn bytes_do_not_depend_on_the_order_of_the_jobs() {
    let own = frame(REST, 0, 0.3);
    let [before, after] = MOVING.map(|pose| frame(pose, 1, 0.3));
    let mut mean = own.clone();
    steady(&mut mean, &[&before, &after], FOOTPRINT, &SteadyParams::DEFAULT, &Backwards, &Silent).unwrap();
    assert_eq!(mean.hash(), averaged(&own, &[&before, &after]).hash());
}

#[test]
fn it_can_be_cancelled() {
    struct Stop;
    impl Progress for Stop {
        fn step(&self, stage: Stage, done: u32, total: u32) -> bool {
            assert_eq!(stage, Stage::Steady);
            assert!(done <= total);
            done == 0
        }
    }
    let own = frame(REST, 0, 0.3);
    let mut mean = own.clone();
    let result = steady(&mut mean, &[&own], FOOTPRINT, &SteadyParams::DEFAULT, &Serial, &Stop);
    assert_eq!(result, Err(Error::Cancelled));
    assert_eq!(mean.hash(), own.hash());
}
