//! Facts of the visual hull (§0).

use facts::{
    Shot,
    outline::{hull_margin, seen_margin},
    topology::{assert_sound, components},
};
use glam::{DVec3, Vec3};
use pcmvs_core::{Params, Preset, Rig, Serial, Silent, View, Workspace, hull::VisualHull};
use std::sync::LazyLock;
use studio::{Faults, Ring, Solid, Subject, dome, noise::Random};

static SPHERE: LazyLock<Shot> = LazyLock::new(|| Shot::small(Subject::Sphere, 20));
static TORUS: LazyLock<Shot> = LazyLock::new(|| Shot::small(Subject::Torus, 12));
static TWO: LazyLock<Shot> = LazyLock::new(|| Shot::small(Subject::TwoBodies, 8));

/// Accuracy of a contour in pixels, away from corners.
const CONTOUR: f64 = 0.25;

fn carve(views: &[View]) -> VisualHull {
    VisualHull::new(views, &Params::preset(Preset::Hull).hull, &Silent).expect("there is a hull")
}

fn single(p: DVec3, rig: &Rig) -> Vec3 {
    (p - rig.origin()).as_vec3()
}

/// A random point in a ball slightly larger than the bounding ball.
fn around(solid: &Solid, random: &mut Random) -> DVec3 {
    let (centre, radius) = solid.ball();
    centre + DVec3::new(random.signed(), random.signed(), random.signed()) * radius * 1.1
}

/// The signed distance is positive inside and negative outside.
#[test]
fn the_signed_distance_has_the_right_sign() {
    for (name, shot) in [("sphere", &*SPHERE), ("torus", &TORUS), ("two bodies", &TWO)] {
        let rig = shot.rig();
        let views = shot.views(&rig);
        let hull = carve(&views);
        let mut random = Random::new(8, 0);
        let (mut inside, mut wrong) = (0, Vec::new());
        for _ in 0..8000 {
            let p = around(shot.truth(), &mut random);
            let margin = hull_margin(shot, p);
            inside += usize::from(margin > CONTOUR);
            if margin.abs() > CONTOUR && (hull.signed_distance(single(p, &rig)) > 0.0) != (margin > 0.0) {
                wrong.push(margin);
            }
        }
        println!("{name}: {inside} inside, wrong: {wrong:?}");
        assert!(inside > 300, "{name}: {inside}");
        assert!(wrong.len() <= 8 && wrong.iter().all(|m| m.abs() < 0.8), "{name}: {wrong:?}");
    }
}

/// The object lies inside its hull, to a fifth of a pixel.
#[test]
fn the_hull_contains_the_object() {
    let rig = SPHERE.rig();
    let views = SPHERE.views(&rig);
    let hull = carve(&views);
    for (p, _) in SPHERE.truth().surface_points(4000, 1) {
        let distance = hull.signed_distance(single(p, &rig));
        assert!(distance > -0.2 * hull.footprint(), "{p}: {} footprints outside", -distance / hull.footprint());
    }
}

fn volume(views: &[View]) -> f64 {
    let mesh = carve(views).mesh(&mut Workspace::default(), &Serial);
    components(&mesh).iter().map(|c| c.volume).sum()
}

/// Every further view makes the hull smaller, and many views leave little more than the object.
#[test]
fn the_hull_shrinks_to_the_object() {
    let truth = 4.0 / 3.0 * core::f64::consts::PI * 0.45 * 0.45 * 0.45;
    let rig = SPHERE.rig();
    let views = SPHERE.views(&rig);
    let every = |n: usize| volume(&views.iter().step_by(n).cloned().collect::<Vec<_>>());
    let volumes = [every(5), every(4), every(2), every(1), truth];
    // Four and five cameras are not nested.
    for (many, few) in [(1, 0), (2, 1), (3, 2), (4, 3)] {
        assert!(volumes[many] < volumes[few], "{volumes:?}");
    }
    let ring = |count, height, seed| Ring { count, height, seed, radius: 3.4, ..Ring::default() }.sized(320, 240);
    let sides = dome(&[ring(10, 2.4, 1), ring(10, 0.9, 2), ring(10, -0.6, 3)]);
    let shot = Shot::new(Subject::Sphere, &sides, &Faults::default());
    let ratio = volume(&shot.views(&shot.rig())) / truth;
    println!("{volumes:?}, {ratio}");
    assert!((1.0..1.01).contains(&ratio), "{ratio}");
}

/// A view without a mask does not change the hull.
#[test]
fn a_view_without_mask_carves_nothing() {
    let rig = TORUS.rig();
    let all = TORUS.views(&rig);
    let mut unmasked = all.clone();
    unmasked[3].silhouette = None;
    let mut without = all.clone();
    without.remove(3);
    assert_eq!(
        carve(&unmasked).mesh(&mut Workspace::default(), &Serial),
        carve(&without).mesh(&mut Workspace::default(), &Serial)
    );
    assert!(volume(&unmasked) > volume(&all));
}

/// A picture that shows a part of the object does not carve the rest.
#[test]
fn what_a_picture_does_not_show_stays() {
    let mut shot = Shot::small(Subject::Sphere, 12);
    // Some see only the left half, one sees a quarter.
    for (i, width, height) in [(0, 160, 240), (4, 150, 240), (7, 165, 110)] {
        crop(&mut shot, i, width, height);
    }
    let rig = shot.rig();
    let views = shot.views(&rig);
    let hull = carve(&views);
    for (p, _) in shot.truth().surface_points(4000, 1) {
        let distance = hull.signed_distance(single(p, &rig));
        assert!(distance > -0.2 * hull.footprint(), "{p}: {} footprints outside", -distance / hull.footprint());
    }
    assert_sound(&hull.mesh(&mut Workspace::default(), &Serial), "cropped");
    assert_eq!(components(&hull.mesh(&mut Workspace::default(), &Serial)).len(), 1);
    // They carve what they do show.
    let (mut carved, mut random) = (0, Random::new(9, 0));
    for _ in 0..4000 {
        let p = around(shot.truth(), &mut random);
        let margin = hull_margin(&shot, p);
        if margin < -CONTOUR {
            carved += 1;
            assert!(hull.signed_distance(single(p, &rig)) < 0.0, "{p}: {margin}");
        }
    }
    assert!(carved > 500);
}

/// Keeps the first columns and rows of a camera's picture and mask.
fn crop(shot: &mut Shot, camera: usize, width: u32, height: u32) {
    let before = shot.cameras[camera].width as usize;
    let rows = |data: &[u8], bytes: usize| -> Vec<u8> {
        let rows = data.chunks_exact(before * bytes).take(height as usize);
        rows.flat_map(|row| &row[..width as usize * bytes]).copied().collect()
    };
    let frame = &mut shot.frame;
    frame.images[camera].rgb = rows(&frame.images[camera].rgb, 3);
    frame.masks[camera] = frame.masks[camera].as_ref().map(|m| rows(m, 1));
    (frame.images[camera].width, frame.images[camera].height) = (width, height);
    (shot.cameras[camera].width, shot.cameras[camera].height) = (width, height);
}

/// Space that fewer than two masks show is outside, whatever the one mask contains.
#[test]
fn one_mask_is_not_enough() {
    let mut shot = Shot::small(Subject::Sphere, 12).of_cameras(&[0, 3, 7, 9, 10]);
    shot.frame.masks[3] = None;
    shot.frame.masks[4] = None;
    crop(&mut shot, 1, 160, 240);
    crop(&mut shot, 2, 320, 118);
    let rig = shot.rig();
    let views = shot.views(&rig);
    let hull = carve(&views);
    let (mut alone, mut random) = (0, Random::new(10, 0));
    for _ in 0..20_000 {
        let p = around(shot.truth(), &mut random);
        let (margin, seeing) = seen_margin(&shot, p);
        if seeing < 2 {
            alone += usize::from(margin > CONTOUR && seeing == 1);
            assert!(hull.signed_distance(single(p, &rig)) < 0.0, "{p}");
        }
    }
    assert!(alone > 100, "{alone}");
}

/// The mesh of the hull is sound even where it is thin, and lies on the surface of the hull.
#[test]
fn the_hulls_mesh_is_closed() {
    let plate = Shot::small(Subject::Plate, 8);
    for (name, shot) in [("sphere", &*SPHERE), ("torus", &TORUS), ("two bodies", &TWO), ("plate", &plate)] {
        let rig = shot.rig();
        let views = shot.views(&rig);
        let hull = carve(&views);
        let mesh = hull.mesh(&mut Workspace::default(), &Serial);
        assert_sound(&mesh, name);
        let mut off: Vec<f32> =
            mesh.positions.iter().map(|p| hull.signed_distance(*p).abs() / hull.footprint()).collect();
        off.sort_by(f32::total_cmp);
        assert!(off[off.len() * 9 / 10] < 0.1, "{name}: {}", off[off.len() * 9 / 10]);
    }
}
