//! §5.2: when two points conflict, which one dies, and what the virtual views add.

use super::super::{
    conflict::clean_conflicts,
    virtual_view::{Viewpoint, virtual_views},
};
use crate::{
    point_cloud::{Point, Rank},
    report::Counts,
    testing::{pinhole, point, ranked, ring},
};
use alloc::{vec, vec::Vec};
use core::f32::consts::PI;
use glam::Vec3;

/// ε.
const DISTANCE: f32 = 0.1;
/// Distance of the cameras from the origin, at which they look.
const AWAY: f32 = 3.0;
/// Size of a pixel there.
const FOOTPRINT: f32 = 0.01;

fn viewpoint(from: Vec3) -> Viewpoint {
    Viewpoint { camera: pinhole(from, Vec3::ZERO, 201, f64::from(AWAY / FOOTPRINT)) }
}

/// What is left of a cloud that is seen by some viewpoints, the first of which are cameras.
fn left(cloud: &[Point], viewpoints: &[Viewpoint], cameras: usize) -> (Vec<Point>, Counts) {
    let (mut cloud, mut counts) = (cloud.to_vec(), Counts::default());
    clean_conflicts(&mut cloud, viewpoints, cameras, DISTANCE, &mut counts, |_| Ok(())).expect("nothing cancels");
    (cloud, counts)
}

fn seen_from_above(cloud: &[Point]) -> (Vec<Point>, Counts) {
    left(cloud, &[viewpoint(Vec3::Z * AWAY)], 1)
}

/// Two points of different views on the axis of the viewpoint above, both facing it, nearer than ε to each other.
fn pair() -> [Point; 2] {
    [point(Vec3::Z * 0.05, Vec3::Z, 1, 2.0), point(Vec3::ZERO, Vec3::Z, 2, 1.0)]
}

#[test]
fn of_two_points_in_conflict_the_less_sure_one_dies() {
    let [upper, lower] = pair();
    let (kept, counts) = seen_from_above(&[upper, lower]);
    assert_eq!((kept, counts.conflicts_cameras, counts.conflicts_virtual), (vec![upper], 1, 0));
    // Whichever is in front, and in whichever order they come.
    let (upper, lower) = (Point { fidelity: 1.0, ..upper }, Point { fidelity: 2.0, ..lower });
    assert_eq!(seen_from_above(&[upper, lower]).0, [lower]);
    assert_eq!(seen_from_above(&[lower, upper]).0, [lower]);
    // Rank goes before fidelity.
    assert_eq!(seen_from_above(&[ranked(upper, Rank::Frontier), lower]).0, [ranked(upper, Rank::Frontier)]);
    assert_eq!(seen_from_above(&[upper, ranked(lower, Rank::Substituted)]).0, [upper]);
    // Neither of two equals is the less sure one.
    let equals = [upper, Point { fidelity: 1.0, ..lower }];
    assert_eq!(seen_from_above(&equals).0, equals);
}

#[test]
fn condition_1_they_project_to_the_same_pixel() {
    let [upper, lower] = pair();
    let aside = Point { position: lower.position + Vec3::X * 1.1 * FOOTPRINT, ..lower };
    assert_eq!(seen_from_above(&[upper, aside]).0, [upper, aside]);
    // Outside the picture there is no pixel.
    let beyond = pair().map(|p| Point { position: p.position + Vec3::X * 1.2, ..p });
    assert_eq!(seen_from_above(&beyond).0, beyond);
    let behind = pair().map(|p| Point { position: p.position + Vec3::Z * 2.0 * AWAY, normal: -Vec3::Z, ..p });
    assert_eq!(seen_from_above(&behind).0, behind);
}

#[test]
fn condition_2_they_are_closer_than_epsilon() {
    let [upper, lower] = pair();
    for (apart, conflict) in [(0.9, true), (1.1, false), (5.0, false)] {
        let cloud = [Point { position: Vec3::Z * apart * DISTANCE, ..upper }, lower];
        assert_eq!(seen_from_above(&cloud).0, cloud[..if conflict { 1 } else { 2 }], "{apart} ε");
    }
}

#[test]
fn condition_3_they_were_detected_from_different_views() {
    let cloud = pair().map(|p| Point { view: 7, ..p });
    assert_eq!(seen_from_above(&cloud).0, cloud);
}

#[test]
fn condition_4_both_normals_face_the_view() {
    // The two sides of a hand.
    for turned in 0..2 {
        let mut cloud = pair();
        cloud[turned].normal = -Vec3::Z;
        assert_eq!(seen_from_above(&cloud).0, cloud);
    }
    let cloud = pair().map(|p| Point { normal: -Vec3::Z, ..p });
    assert_eq!(seen_from_above(&cloud).0, cloud);
    // From below both face the viewpoint again.
    assert_eq!(left(&cloud, &[viewpoint(Vec3::Z * -AWAY)], 1).0, cloud[..1]);
}

#[test]
fn an_implicit_point_dies_as_soon_as_it_hides_a_valid_one() {
    let implicit = ranked(point(Vec3::Z * 0.8, Vec3::Z, Point::NO_VIEW, 0.0), Rank::Implicit);
    let valid = point(Vec3::ZERO, Vec3::Z, 2, 0.1);
    // However far in front, and however little the other is trusted.
    for rank in [Rank::Substituted, Rank::Detected, Rank::Frontier] {
        let valid = ranked(valid, rank);
        let (kept, counts) = seen_from_above(&[implicit, valid]);
        assert_eq!((kept, counts.implicit_removed), (vec![valid], 1));
        // Behind it does no harm, and it never takes a valid point's place.
        let behind = Point { position: Vec3::Z * -0.02, ..implicit };
        assert_eq!(seen_from_above(&[behind, valid]).0, [behind, valid]);
    }
    // Another implicit point is not a valid one.
    let two = [implicit, Point { position: Vec3::ZERO, ..implicit }];
    assert_eq!(seen_from_above(&two).0, two);
}

#[test]
fn the_dead_do_not_kill() {
    // The first viewpoint sees the surest of three remove the second: by the second viewpoint, that one is gone and the third stays.
    let across = |x: f32, z: f32, view, fidelity| point(Vec3::new(x, 0.0, z), Vec3::new(1.0, 0.0, 1.0), view, fidelity);
    let cloud = [across(0.0, 0.05, 0, 3.0), across(0.0, 0.0, 1, 2.0), across(-0.05, 0.0, 2, 1.0)];
    let (above, beside) = (|| viewpoint(Vec3::Z * AWAY), || viewpoint(Vec3::X * AWAY));
    assert_eq!(left(&cloud, &[above(), beside()], 2).0, [cloud[0], cloud[2]]);
    assert_eq!(left(&cloud, &[beside(), above()], 2).0, [cloud[0]]);
}

fn virtual_viewpoints() -> Vec<Viewpoint> {
    virtual_views(50, Vec3::ZERO, AWAY, 0.8, FOOTPRINT)
}

#[test]
fn virtual_views_find_a_conflict_that_no_camera_sees() {
    let cameras = || ring(8, 2.8, 1.0).map(viewpoint).collect::<Vec<_>>();
    // Two points one behind the other for a view from below, where no camera stands.
    let below =
        virtual_viewpoints().into_iter().map(|e| e.camera.centre.normalize()).min_by(|a, b| a.z.total_cmp(&b.z));
    let below = below.expect("there are 50");
    let cloud = [point(below * 0.05, below, 1, 2.0), point(Vec3::ZERO, below, 2, 1.0)];
    assert_eq!(left(&cloud, &cameras(), 8).0, cloud);
    let viewpoints: Vec<Viewpoint> = cameras().into_iter().chain(virtual_viewpoints()).collect();
    let (kept, counts) = left(&cloud, &viewpoints, 8);
    assert_eq!((kept, counts.conflicts_cameras, counts.conflicts_virtual), (vec![cloud[0]], 0, 1));
}

#[test]
fn virtual_views_are_even_on_the_sphere_through_the_cameras() {
    let target = Vec3::new(0.3, -0.2, 0.1);
    let viewpoints = virtual_views(50, target, AWAY, 0.8, FOOTPRINT);
    assert_eq!(viewpoints.len(), 50);
    let directions: Vec<Vec3> = viewpoints.iter().map(|e| (e.camera.centre - target) / AWAY).collect();
    for (viewpoint, d) in viewpoints.iter().zip(&directions) {
        assert!((d.length() - 1.0).abs() < 1e-5, "{d}");
        // Each looks at the target, with the cameras' footprint, and sees the whole ball around it.
        assert!((viewpoint.camera.depth(target) - AWAY).abs() < 1e-4);
        let pixel = |p: Vec3| viewpoint.pixel(p);
        assert!((viewpoint.camera.footprint(viewpoint.camera.depth(target)) / FOOTPRINT - 1.0).abs() < 1e-4);
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z] {
            assert!(pixel(target + axis * 0.8).is_some());
        }
    }
    // Fifty discs of equal size cover a sphere at 16.4° each. Neighbours are about twice that apart.
    let degrees = |a: Vec3, b: Vec3| libm::acosf(a.dot(b).clamp(-1.0, 1.0)) * 180.0 / PI;
    for (i, a) in directions.iter().enumerate() {
        let others = directions.iter().enumerate().filter(|&(j, _)| j != i);
        let nearest = others.map(|(_, b)| degrees(*a, *b)).fold(180.0, f32::min);
        assert!((18.0..34.0).contains(&nearest), "{nearest}°");
    }
    // Nowhere is the next one far.
    for probe in virtual_views(997, Vec3::ZERO, 1.0, 0.8, FOOTPRINT).iter().map(|e| e.camera.centre) {
        let nearest = directions.iter().map(|d| degrees(*d, probe)).fold(180.0, f32::min);
        assert!(nearest < 26.0, "{nearest}°");
    }
}
