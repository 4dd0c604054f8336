//! §5.1: eq. 2 and which points stay.

use super::super::downsample::downsample;
use crate::{
    point_cloud::{Point, PointCloud, Rank},
    report::Counts,
    testing::{law, point, ranked},
};
use alloc::{vec, vec::Vec};
use glam::Vec3;
use proptest::prelude::*;

const RADIUS: f32 = 1.0;
/// α of eq. 2: 60°.
const AGREEMENT: f32 = 0.5;
/// Fidelity from which points stay in any case.
const HIGH: f32 = 3.0;

fn thin(cloud: &[Point]) -> (PointCloud, Counts) {
    let mut counts = Counts::default();
    let kept = downsample(cloud, RADIUS, HIGH, AGREEMENT, &mut counts);
    (kept, counts)
}

/// A point on the plane z = 0 with a normal that leans by some degrees.
fn leaning(x: f32, degrees: f32, view: u16, fidelity: f32) -> Point {
    let (sin, cos) = libm::sincosf(degrees.to_radians());
    point(Vec3::new(x, 0.0, 0.0), Vec3::new(sin, 0.0, cos), view, fidelity)
}

/// A point on the plane z = 0.
fn upright(x: f32, view: u16, fidelity: f32) -> Point {
    leaning(x, 0.0, view, fidelity)
}

#[test]
fn eq_2_drops_a_normal_that_leans_from_the_mean() {
    // The mean of eight upright normals and one that leans by 64° leans by 6.0°: 58° remain. At 68° it is 61.7°.
    for (degrees, stays) in [(0.0, true), (64.0, true), (68.0, false), (120.0, false), (180.0, false)] {
        let mut cloud: Vec<_> = (0..8).map(|i| upright(0.05 * i as f32, 0, 1.0)).collect();
        cloud.push(leaning(0.2, degrees, 0, 1.0));
        let (kept, counts) = thin(&cloud);
        assert_eq!(counts.dropped_normal, u32::from(!stays), "{degrees}°");
        assert_eq!(kept, cloud[..8 + usize::from(stays)], "{degrees}°");
    }
    // However sure the point is below the high threshold, and whichever view it comes from.
    let mut cloud: Vec<_> = (0..8).map(|i| upright(0.05 * i as f32, 0, 1.0)).collect();
    cloud.push(leaning(0.2, 90.0, 1, 2.9));
    assert_eq!(thin(&cloud).1.dropped_normal, 1);
    // Neighbours beyond the radius have no say.
    for neighbour in &mut cloud[..8] {
        neighbour.position.x -= 1.5;
    }
    assert_eq!(thin(&cloud).1.dropped_normal, 0);
}

#[test]
fn of_neighbours_from_several_views_the_surest_stays() {
    let cloud = [upright(0.0, 0, 1.0), upright(0.3, 1, 2.0), upright(0.6, 2, 1.5)];
    let (kept, counts) = thin(&cloud);
    assert_eq!((kept, counts.dropped_fidelity), (vec![cloud[1]], 2));
    // Points of the same view do not compete.
    let cloud = cloud.map(|p| Point { view: 4, ..p });
    assert_eq!(thin(&cloud).0, cloud);
    // Nor do points that are apart; "for every neighbour" is not "for the next one".
    let cloud = [upright(0.0, 0, 1.0), upright(0.9, 1, 2.0), upright(1.8, 0, 2.5)];
    assert_eq!(thin(&cloud).0, [cloud[2]]);
    let cloud = [upright(0.0, 0, 1.0), upright(1.1, 1, 2.0)];
    assert_eq!(thin(&cloud).0, cloud);
    // Of equals one stays.
    let cloud = [upright(0.0, 0, 1.0), upright(0.1, 1, 1.0), upright(0.2, 2, 1.0)];
    assert_eq!(thin(&cloud).0, [cloud[0]]);
}

#[test]
fn frontier_implicit_and_sure_points_stay() {
    // Crowded by surer points of other views, and leaning away from all of them.
    let crowd: Vec<_> = (0..6).map(|i| upright(0.1 * i as f32, i, 2.9)).collect();
    let weak = leaning(0.25, 150.0, 9, 0.1);
    let stays = |p: Point| thin(&[&crowd[..], &[p]].concat()).0.contains(&p);
    assert!(stays(ranked(weak, Rank::Frontier)));
    assert!(stays(ranked(weak, Rank::Implicit)));
    assert!(stays(Point { fidelity: HIGH, ..weak }));
    assert!(!stays(weak));
    assert!(!stays(ranked(weak, Rank::Substituted)));
}

#[test]
fn rank_goes_before_fidelity_and_implicit_points_displace_nothing() {
    let sure = upright(0.0, 0, 2.5);
    let frontier = ranked(upright(0.1, 1, 0.2), Rank::Frontier);
    assert_eq!(thin(&[sure, frontier]).0, [frontier]);
    let substituted = ranked(upright(0.1, 1, 2.9), Rank::Substituted);
    assert_eq!(thin(&[sure, substituted]).0, [sure]);
    let implicit = ranked(leaning(0.1, 180.0, Point::NO_VIEW, 2.9), Rank::Implicit);
    assert_eq!(thin(&[sure, implicit]).0, [sure, implicit]);
}

fn any_rank() -> impl Strategy<Value = Rank> {
    prop::sample::select(vec![Rank::Implicit, Rank::Substituted, Rank::Detected, Rank::Frontier])
}

fn any_point() -> impl Strategy<Value = Point> {
    let place = prop::array::uniform3(0.0..3.0f32);
    (place, 0.0..50.0f32, 0..4u16, 0.0..4.0f32, any_rank()).prop_map(|(place, degrees, view, fidelity, rank)| {
        // In halves, so that ties are common.
        let fidelity = libm::floorf(2.0 * fidelity) / 2.0;
        ranked(Point { position: Vec3::from_array(place), ..leaning(0.0, degrees, view, fidelity) }, rank)
    })
}

proptest! {
    #![proptest_config(law(200))]

    /// What is kept is apart, and what is dropped has a neighbour to blame. Normals lean so little that eq. 2 keeps all.
    #[test]
    fn kept_points_are_apart_and_dropped_ones_had_a_better_neighbour(
        cloud in prop::collection::vec(any_point(), 1..80),
    ) {
        let (kept, counts) = thin(&cloud);
        prop_assert_eq!(counts.dropped_normal, 0);
        prop_assert_eq!(counts.dropped_fidelity as usize, cloud.len() - kept.len());
        let secured = |p: &Point| matches!(p.rank, Rank::Frontier | Rank::Implicit) || p.fidelity >= HIGH;
        let near = |a: &Point, b: &Point| (a.position - b.position).length() <= RADIUS && a.view != b.view;
        let rivals = |p: &Point| cloud.iter().filter(|q| near(p, q) && q.rank != Rank::Implicit).copied().collect::<Vec<_>>();
        for p in &cloud {
            let lost = rivals(p).iter().any(|q| (q.rank, q.fidelity) >= (p.rank, p.fidelity));
            let beaten = rivals(p).iter().any(|q| (q.rank, q.fidelity) > (p.rank, p.fidelity));
            if secured(p) {
                prop_assert!(kept.contains(p), "a secured point is gone: {p:?}");
            } else if kept.contains(p) {
                prop_assert!(!beaten, "kept despite a better neighbour: {p:?}");
            } else {
                prop_assert!(lost, "dropped for nothing: {p:?}");
            }
        }
        // In the order in which they came.
        let mut rest = cloud.iter();
        prop_assert!(kept.iter().all(|p| rest.any(|q| q == p)));
    }
}
