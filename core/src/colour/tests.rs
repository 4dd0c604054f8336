mod gains;

use super::*;
use crate::{Camera, Lens, Pinhole, Serial, Silent, error::Error, silhouette::Silhouette};
use alloc::sync::Arc;
use glam::{DMat3, DVec3};

const SIZE: u32 = 200;

/// A ball: centre, radius, and colour as a function of the direction from the centre.
struct Ball(Vec3, f32, fn(Vec3) -> Vec3);

fn red(_: Vec3) -> Vec3 {
    Vec3::new(200.0, 40.0, 40.0)
}

fn blue(_: Vec3) -> Vec3 {
    Vec3::new(40.0, 40.0, 200.0)
}

fn smooth(n: Vec3) -> Vec3 {
    Vec3::splat(120.0) + n * 60.0
}

/// A closed mesh along latitudes and longitudes, counter-clockwise as seen from outside.
fn mesh(balls: &[Ball]) -> Mesh {
    const ROWS: u32 = 40;
    const COLUMNS: u32 = 80;
    let mut mesh = Mesh::default();
    for Ball(centre, radius, _) in balls {
        let first = mesh.positions.len() as u32;
        let mut add = |theta: f32, phi: f32| {
            let n =
                Vec3::new(libm::sinf(theta) * libm::cosf(phi), libm::sinf(theta) * libm::sinf(phi), libm::cosf(theta));
            mesh.positions.push(*centre + n * *radius);
            mesh.normals.push(n);
        };
        let pi = core::f32::consts::PI;
        for r in 1..ROWS {
            (0..COLUMNS).for_each(|c| add(pi * r as f32 / ROWS as f32, 2.0 * pi * c as f32 / COLUMNS as f32));
        }
        add(0.0, 0.0);
        add(pi, 0.0);
        let (north, south) = (first + (ROWS - 1) * COLUMNS, first + (ROWS - 1) * COLUMNS + 1);
        let at = |r: u32, c: u32| first + r * COLUMNS + c % COLUMNS;
        for c in 0..COLUMNS {
            mesh.triangles.push([north, at(0, c), at(0, c + 1)]);
            mesh.triangles.push([south, at(ROWS - 2, c + 1), at(ROWS - 2, c)]);
            for r in 0..ROWS - 2 {
                mesh.triangles.push([at(r, c), at(r + 1, c), at(r + 1, c + 1)]);
                mesh.triangles.push([at(r, c), at(r + 1, c + 1), at(r, c + 1)]);
            }
        }
    }
    mesh
}

fn camera(from: DVec3) -> Camera {
    let forward = -from.normalize();
    let right = forward.cross(DVec3::Z).normalize();
    let r = DMat3::from_cols(right, forward.cross(right), forward).transpose();
    let rows = |m: DMat3| m.transpose().to_cols_array_2d();
    let c = f64::from(SIZE - 1) / 2.0;
    Camera {
        width: SIZE,
        height: SIZE,
        k: [[260.0, 0.0, c], [0.0, 260.0, c], [0.0, 0.0, 1.0]],
        lens: Lens::NONE,
        r: rows(r),
        t: (-(r * from)).to_array(),
    }
}

/// A picture of the balls in front of a green backdrop, with its silhouette.
fn photograph(balls: &[Ball], index: u16, from: DVec3, gain: Vec3) -> View {
    let camera = Pinhole::new(&camera(from), DVec3::ZERO);
    let (mut rgb, mut coverage) = (Vec::new(), Vec::new());
    for i in 0..SIZE * SIZE {
        let ray = camera.ray((i % SIZE) as f32, (i / SIZE) as f32);
        let mut nearest = (f32::INFINITY, Vec3::new(30.0, 160.0, 60.0));
        for Ball(centre, radius, colour) in balls {
            let d = camera.centre - *centre;
            let (a, b, c) = (ray.length_squared(), ray.dot(d), d.length_squared() - radius * radius);
            let root = b * b - a * c;
            let t = (-b - libm::sqrtf(root.max(0.0))) / a;
            if root > 0.0 && t < nearest.0 {
                nearest = (t, colour((d + ray * t) / *radius) * gain);
            }
        }
        rgb.extend(nearest.1.to_array().map(|v| libm::roundf(v) as u8));
        coverage.push(if nearest.0 < f32::INFINITY { 255 } else { 0 });
    }
    let silhouette = Some(Silhouette::from_coverage(SIZE, SIZE, &coverage, |_| true).unwrap());
    View { rgb, ..View::of_silhouette(index, camera, silhouette.map(Arc::new)) }
}

fn ring(balls: &[Ball], count: u32, gain: impl Fn(u32) -> Vec3) -> Vec<View> {
    (0..count)
        .map(|i| {
            let a = 2.0 * core::f64::consts::PI * f64::from(i) / f64::from(count);
            let from = DVec3::new(4.0 * libm::cos(a), 4.0 * libm::sin(a), 1.5);
            photograph(balls, i as u16, from, gain(i))
        })
        .collect()
}

const PAPER: ColourParams = ColourParams { gains: None, blended_views: 1 };

fn worst(mesh: &Mesh, truth: impl Fn(usize) -> Vec3, counts: impl Fn(usize) -> bool) -> f32 {
    let error = |v: usize| (Vec3::from_array(mesh.colours[v].map(f32::from)) - truth(v)).abs().max_element();
    (0..mesh.colours.len()).filter(|&v| counts(v)).map(error).fold(0.0, f32::max)
}

#[test]
fn seen_vertices_take_the_surface_colour() {
    let balls = [Ball(Vec3::ZERO, 1.0, smooth)];
    let views = ring(&balls, 8, |_| Vec3::ONE);
    for blended_views in [1, 3] {
        let mut mesh = mesh(&balls);
        colour(
            &mut mesh,
            &views,
            None,
            &ColourParams { blended_views, ..PAPER },
            &mut Workspace::default(),
            &Serial,
            &Silent,
        )
        .unwrap();
        let normals = mesh.normals.clone();
        // At the upper pole all cameras look along the surface, and no camera sees the lower pole.
        let error = worst(&mesh, |v| smooth(normals[v]), |v| (-0.3..0.9).contains(&normals[v].z));
        assert!(error < 2.0, "{blended_views}: {error}");
    }
}

/// A picture that was cut out along a matte shows nothing where the matte lacks something, whatever the other views have
/// made of the silhouette since.
#[test]
fn what_was_cut_out_of_a_picture_gives_no_colour() {
    let balls = [Ball(Vec3::ZERO, 1.0, smooth)];
    let mut views = ring(&balls, 8, |_| Vec3::ONE);
    let completed = views[0].silhouette.clone();
    let distances = completed.as_ref().unwrap().distances();
    let in_stripe = |i: usize| (i % SIZE as usize).abs_diff(SIZE as usize / 2) < 8;
    let coverage = |(i, &d): (usize, &i16)| if d > 0 && !in_stripe(i) { 255 } else { 0 };
    let coverage: Vec<u8> = distances.iter().enumerate().map(coverage).collect();
    let lacking = Silhouette::from_coverage(SIZE, SIZE, &coverage, |_| true).unwrap();
    views[0].rgb.chunks_exact_mut(3).zip(&coverage).filter(|&(_, &c)| c == 0).for_each(|(pixel, _)| pixel.fill(255));
    let given = Some(Arc::new(lacking));
    for silhouette in [completed, None] {
        views[0] = View { cut_out: true, given: given.clone(), silhouette, ..views[0].clone() };
        let mut mesh = mesh(&balls);
        colour(&mut mesh, &views, None, &PAPER, &mut Workspace::default(), &Serial, &Silent).unwrap();
        let normals = mesh.normals.clone();
        let error = worst(&mesh, |v| smooth(normals[v]), |v| (-0.3..0.9).contains(&normals[v].z));
        assert!(error < 2.0, "{error}");
    }
}

#[test]
fn hidden_vertices_never_take_the_colour_of_what_hides_them() {
    // Seen from each camera, one ball hides a part of the other.
    let balls = [Ball(Vec3::new(0.0, 0.0, -0.3), 0.7, blue), Ball(Vec3::new(0.95, 0.0, 0.1), 0.2, red)];
    for blended_views in [1, 3] {
        let mut mesh = mesh(&balls);
        colour(
            &mut mesh,
            &ring(&balls, 8, |_| Vec3::ONE),
            None,
            &ColourParams { blended_views, ..PAPER },
            &mut Workspace::default(),
            &Serial,
            &Silent,
        )
        .unwrap();
        let half = mesh.positions.len() / 2;
        let truth = |v: usize| if v < half { blue(Vec3::ZERO) } else { red(Vec3::ZERO) };
        let error = worst(&mesh, truth, |_| true);
        // The tolerance allows for the ringing of the cubic kernel at a step of 160 levels.
        assert!(error < 8.0, "{blended_views}: {error}");
    }
}

#[test]
fn gains_make_the_cameras_agree() {
    let gain = |i: u32| Vec3::new(1.0 + 0.15 * libm::sinf(i as f32), 1.0 - 0.1 * libm::cosf(3.0 * i as f32), 1.0);
    let balls = [Ball(Vec3::ZERO, 1.0, smooth)];
    let views = ring(&balls, 8, gain);
    // One gain per channel is undetermined: the geometric mean over the cameras.
    let mean = Vec3::from_array(core::array::from_fn(|c| {
        libm::expf((0..8).map(|i| libm::logf(gain(i)[c])).sum::<f32>() / 8.0)
    }));
    let error = |gains| {
        let mut mesh = mesh(&balls);
        colour(
            &mut mesh,
            &views,
            None,
            &ColourParams { gains, blended_views: 1 },
            &mut Workspace::default(),
            &Serial,
            &Silent,
        )
        .unwrap();
        let normals = mesh.normals.clone();
        worst(&mesh, |v| smooth(normals[v]) * mean, |v| normals[v].z > -0.3)
    };
    let (with, without) = (error(Some(GainParams { min_score: 0.5, prior: 1.0 })), error(None));
    assert!(with < 3.0 && without > 12.0, "{with} {without}");
}

#[test]
fn unseen_vertices_continue_their_surroundings() {
    // No camera sees the lower sides of the balls. Each must get the colour of its own ball.
    let balls = [Ball(Vec3::new(-0.6, 0.0, 0.0), 0.4, red), Ball(Vec3::new(0.6, 0.0, 0.0), 0.4, blue)];
    let mut mesh = mesh(&balls);
    let views = vec![photograph(&balls, 0, DVec3::new(0.01, 0.0, 4.0), Vec3::ONE)];
    colour(&mut mesh, &views, None, &PAPER, &mut Workspace::default(), &Serial, &Silent).unwrap();
    let half = mesh.positions.len() / 2;
    let error = worst(&mesh, |v| if v < half { red(Vec3::ZERO) } else { blue(Vec3::ZERO) }, |_| true);
    assert!(error < 8.0, "{error}");
    // Without any view all vertices are grey.
    colour(&mut mesh, &[], None, &PAPER, &mut Workspace::default(), &Serial, &Silent).unwrap();
    assert!(mesh.colours.iter().all(|&c| c == [128; 3]));
}

#[test]
fn cancelling_stops() {
    struct Stop;
    impl Progress for Stop {
        fn step(&self, _: Stage, done: u32, _: u32) -> bool {
            done < 2
        }
    }
    let balls = [Ball(Vec3::ZERO, 1.0, smooth)];
    let mut mesh = mesh(&balls);
    let cancelled =
        colour(&mut mesh, &ring(&balls, 3, |_| Vec3::ONE), None, &PAPER, &mut Workspace::default(), &Serial, &Stop);
    assert_eq!(cancelled.map(|coloured| coloured.gains), Err(Error::Cancelled));
}
