//! Averaging a take in time makes it steady and drags nothing: measured at material points of the moving figure.

use facts::{Shot, threads, topology::assert_sound};
use glam::DVec3;
use libm::sqrt;
use pcmvs_core::{Frame, Memory, Mesh, Params, Preset, Rig, Silent, steady::SteadyParams};
use studio::{Capture, Faults, Ring, Subject, TriangleMesh, score};

const FRAMES: usize = 5;
/// Frames per second.
const RATE: f64 = 30.0;
/// Largest distance of a mesh that is measured, in footprints.
const FAR: f64 = 3.0;

/// What the meshes of a take are like at points of the figure's surface that all frames see.
struct Measured {
    /// Speed of each point in footprints per frame.
    speed: Vec<f64>,
    /// Standard deviation over the frames of the distance of the mesh from each point, in footprints.
    jitter: Vec<f64>,
    /// Mean over the frames of its magnitude.
    error: Vec<f64>,
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

impl Measured {
    fn new(shots: &[Shot], meshes: &[Mesh]) -> Self {
        let footprint = shots[0].footprint(shots[0].rig().origin());
        let world: Vec<TriangleMesh> = shots.iter().zip(meshes).map(|(shot, mesh)| shot.in_world(mesh)).collect();
        let grids: Vec<score::TriangleGrid> =
            world.iter().map(|mesh| score::TriangleGrid::new(mesh, FAR * footprint)).collect();
        let mut found = Self { speed: Vec::new(), jitter: Vec::new(), error: Vec::new() };
        for (p, _) in shots[0].truth().surface_points(4000, 0) {
            let Some(material) = shots[0].truth().material(p) else { continue };
            let places: Vec<(DVec3, DVec3)> = shots
                .iter()
                .map(|shot| {
                    let p = shot.truth().place(material);
                    (p, shot.truth().normal(p))
                })
                .collect();
            let is_seen = |(shot, &(p, n)): (&Shot, &(DVec3, DVec3))| {
                let seeing = shot.cameras.iter().filter(|camera| score::sees(shot.truth(), camera, p, n));
                shot.truth().distance(p).abs() < 1e-4 && seeing.take(2).count() == 2
            };
            if !shots.iter().zip(&places).all(is_seen) {
                continue;
            }
            let distances: Option<Vec<f64>> =
                grids.iter().zip(&places).map(|(grid, &(p, n))| grid.along(p, n)).collect();
            let Some(distances) = distances else { continue };
            let count = distances.len() as f64;
            let mean = distances.iter().sum::<f64>() / count;
            let variance = distances.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / count;
            found.jitter.push(sqrt(variance) / footprint);
            found.error.push(distances.iter().map(|d| d.abs()).sum::<f64>() / count / footprint);
            let way = (places[FRAMES - 1].0 - places[0].0).length();
            found.speed.push(way / (FRAMES - 1) as f64 / footprint);
        }
        found
    }

    /// The median of some values of points whose speed is in a range.
    fn of(&self, values: &[f64], speed: std::ops::Range<f64>) -> f64 {
        let chosen: Vec<f64> =
            self.speed.iter().zip(values).filter(|(s, _)| speed.contains(s)).map(|(_, &v)| v).collect();
        assert!(chosen.len() > 30, "{} points with a speed of {speed:?}", chosen.len());
        median(chosen)
    }
}

/// Reconstructs every frame by itself, and averages each with those before and after it.
fn alone_and_averaged(shots: &[Shot]) -> [Vec<Mesh>; 2] {
    let (rig, threads): (Rig, _) = (shots[0].rig(), threads(2));
    let mut frames: Vec<Frame<&Rig>> = shots
        .iter()
        .map(|shot| {
            let mut frame = Frame::new(&rig, Params::preset(Preset::Default), Memory::default());
            frame.run_all(&shot.inputs(), &threads, &Silent).expect("the studio's frames are sound");
            frame
        })
        .collect();
    let alone: Vec<Mesh> = frames.iter().map(|frame| frame.own_mesh().clone()).collect();
    for (i, frame) in frames.iter_mut().enumerate() {
        let near = i.saturating_sub(1)..(i + 2).min(FRAMES);
        let neighbours: Vec<&Mesh> = near.filter(|&other| other != i).map(|other| &alone[other]).collect();
        frame.steady(&neighbours, &SteadyParams::DEFAULT, &threads, &Silent).expect("nothing cancels it");
        assert_sound(frame.mesh(), "averaged");
        assert!(frame.mesh().triangles == alone[i].triangles);
    }
    let averaged = frames.iter().map(|frame| frame.mesh().clone()).collect();
    [alone, averaged]
}

#[test]
fn a_take_is_steadier_and_its_fast_limbs_stay_where_they_are() {
    let cameras = Ring { count: 12, ..Ring::default() }.sized(400, 300).cameras();
    let faults = Faults { noise: 4.0, contour_error: 0.7, ..Faults::default() };
    let times: Vec<f64> = (0..FRAMES).map(|frame| frame as f64 / RATE).collect();
    let capture = Capture::new(Subject::Figure, &cameras, &times, &faults);
    let shots: Vec<Shot> =
        capture.frames.iter().map(|frame| Shot { cameras: capture.cameras.clone(), frame: frame.clone() }).collect();
    let [alone, averaged] = alone_and_averaged(&shots).map(|meshes| Measured::new(&shots, &meshes));
    // The fast points are those of the waving hand, which is so thin that its tips shrink.
    let classes = [("slow", 0.0..0.5, 0.75, 0.95), ("moving", 0.5..2.0, 0.75, 0.95), ("fast", 2.0..f64::MAX, 0.9, 1.2)];
    for (what, speed, jitter_left, error_left) in classes {
        let [jitter, error] = [|m: &Measured| m.jitter.clone(), |m: &Measured| m.error.clone()]
            .map(|values| [&alone, &averaged].map(|m| m.of(&values(m), speed.clone())));
        println!("{what}: jitter {jitter:.3?}, error {error:.3?} footprints");
        assert!(jitter[1] < jitter_left * jitter[0], "{what}: {jitter:?}");
        assert!(error[1] < error_left * error[0], "{what}: {error:?}");
    }
}
