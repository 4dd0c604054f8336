//! Cameras stand where the cameras of a dome stand.

use glam::DVec3;
use pcmvs_core::Rig;
use studio::{Ring, dome, pairs};

#[test]
fn the_default_is_the_papers_dome() {
    let cameras = Ring::default().cameras();
    assert_eq!(cameras.len(), 20);
    let rig = Rig::new(&cameras).unwrap();
    let subject = DVec3::new(0.0, 0.0, 0.9);
    assert!((rig.origin() - subject).length() < 0.05);
    for camera in &cameras {
        let to = subject - camera.centre();
        assert!((to.length() - 3.8).abs() < 0.06);
        assert!((libm::asin(-to.z / to.length()).to_degrees() - 20.0).abs() < 1.5);
        // The whole figure is in every picture, upright.
        let [feet, top] = [0.0, 1.75].map(|z| camera.project(DVec3::new(0.0, 0.0, z)).unwrap().0.y);
        assert!(top > 0.0 && feet < 767.0 && feet - top > 400.0, "{top} to {feet}");
    }
}

#[test]
fn an_even_ring_looks_at_its_point() {
    let ring = Ring { unevenness: 0.0, count: 8, ..Ring::default() };
    let cameras = ring.cameras();
    for (i, camera) in cameras.iter().enumerate() {
        let (pixel, depth) = camera.project(ring.look_at).unwrap();
        assert!((pixel - glam::DVec2::new(511.5, 383.5)).length() < 1e-9);
        assert!((depth - (ring.look_at - camera.centre()).length()).abs() < 1e-9);
        let next = &cameras[(i + 1) % 8];
        let apart = (camera.centre() - next.centre()).length();
        assert!((apart - 2.0 * ring.radius * libm::sin(core::f64::consts::PI / 8.0)).abs() < 1e-9);
    }
}

/// A ring can be aimed at a part of the subject, which its pictures then cut off.
#[test]
fn a_ring_is_aimed_at_a_part() {
    for camera in Ring::default().aimed(1.35, 0.32).cameras() {
        let [feet, chest, top] = [0.0, 1.35, 1.75].map(|z| camera.project(DVec3::new(0.0, 0.0, z)).unwrap().0.y);
        assert!((chest - 383.5).abs() < 40.0 && top > 0.0 && feet > 767.0, "{top}, {chest}, {feet}");
    }
}

#[test]
fn pairs_and_domes() {
    assert_eq!(pairs(20), [0, 1, 4, 5, 8, 9, 12, 13, 16, 17]);
    let rings = [Ring { count: 6, ..Ring::default() }, Ring { count: 4, height: 3.0, seed: 2, ..Ring::default() }];
    let cameras = dome(&rings);
    assert_eq!(cameras.len(), 10);
    Rig::new(&cameras).unwrap();
}
