use super::{
    AgreementParams,
    blame::Blame,
    contradicting,
    coverage::{Coverage, PIXELS_PER_SAMPLE, contour_length},
    excluders::{Excluders, Sets},
};
use crate::{
    executor::Serial,
    progress::Silent,
    silhouette::ContourEdge,
    testing::{pinhole, ring, silhouette_of, sphere},
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use glam::Vec3;

const NONE: u16 = u16::MAX;

fn blame(pixels: &[(u16, f32, &[Excluders])]) -> Blame {
    let mut blame = Blame::new(8);
    for &(view, weight, sets) in pixels {
        let mut all = Sets::new();
        sets.iter().for_each(|&set| all.add(set));
        blame.add(view, weight, all);
    }
    blame
}

/// The views at fault alone.
fn at_fault(blame: &Blame, limit: f32, most: usize) -> Vec<u16> {
    blame.at_fault(limit, most).into_iter().map(|(view, _)| view).collect()
}

/// The two views with the most pixels do not count: with two there is nothing, with four there is what the other two have.
#[test]
fn two_views_blame_nobody() {
    let set: &[Excluders] = &[[7, NONE, NONE]];
    let two = blame(&[(0, 100.0, set), (1, 100.0, set)]);
    assert!(at_fault(&two, 1.0, 8).is_empty());
    let four = blame(&[(0, 100.0, set), (1, 100.0, set), (2, 5.0, set), (3, 4.0, set)]);
    assert_eq!(at_fault(&four, 9.0, 8), [7]);
    assert!(at_fault(&four, 9.5, 8).is_empty());
}

/// Of several places on a ray the one that fewest views exclude counts.
#[test]
fn the_most_plausible_place_counts() {
    let sets: &[Excluders] = &[[5, 6, NONE], [7, NONE, NONE]];
    let found = blame(&[(0, 10.0, sets), (1, 10.0, sets), (2, 10.0, sets)]);
    assert_eq!(at_fault(&found, 10.0, 8), [7]);
}

/// What a view at fault explains is not held against others, and what remains falls on the other view of a pair.
#[test]
fn what_is_explained_is_not_held_against_others() {
    let (shared, alone): (&[Excluders], &[Excluders]) = (&[[6, 7, NONE]], &[[7, NONE, NONE]]);
    let mut pixels: Vec<(u16, f32, &[Excluders])> = (0..5).map(|from| (from, 20.0, alone)).collect();
    pixels.extend((0..5).map(|from| (from, 6.0, shared)));
    // Against 7 there are 3 · (20 + 3) pixels. Without it, 3 · 6 are held against 6 alone.
    assert_eq!(at_fault(&blame(&pixels), 18.0, 8), [7, 6]);
    assert_eq!(at_fault(&blame(&pixels), 18.5, 8), [7]);
    let either: &[Excluders] = &[[6, NONE, NONE], [7, NONE, NONE]];
    let pixels: Vec<(u16, f32, &[Excluders])> =
        (0..5).flat_map(|from| [(from, 20.0, alone), (from, 6.0, either)]).collect();
    assert_eq!(at_fault(&blame(&pixels), 1.0, 8), [7], "explained by the view at fault");
}

/// Pixels of a view at fault say nothing, and there are not more views at fault than asked for.
#[test]
fn pixels_of_views_at_fault_do_not_count() {
    let (against_7, against_6): (&[Excluders], &[Excluders]) = (&[[7, NONE, NONE]], &[[6, NONE, NONE]]);
    let mut pixels: Vec<(u16, f32, &[Excluders])> = (0..4).map(|from| (from, 50.0, against_7)).collect();
    pixels.extend([(7, 90.0, against_6), (0, 10.0, against_6), (1, 10.0, against_6)]);
    assert_eq!(at_fault(&blame(&pixels), 9.0, 8), [7], "without 7 only two views blame 6");
    assert!(at_fault(&blame(&pixels), 9.0, 0).is_empty());
}

/// The mesh of a ball covers its silhouette. A smaller one leaves a rim uncovered, whose area is known.
#[test]
fn what_a_mesh_leaves_uncovered_is_measured() {
    let camera = pinhole(Vec3::new(4.0, 0.0, 0.0), Vec3::ZERO, 200, 400.0);
    let view = silhouette_of(&[(Vec3::ZERO, 0.6)], &camera, 0);
    let silhouette = view.silhouette.as_ref().expect("it has one");
    let mut coverage = Coverage::default();
    let mut area = |radius: f32| {
        coverage.draw(&sphere(Vec3::ZERO, radius), &camera);
        coverage.uncovered(silhouette, 0.0).len() as f32 * PIXELS_PER_SAMPLE
    };
    assert_eq!(area(0.6), 0.0);
    // Radii in pixels; the rim begins 1.5 pixels inside the contour and 1 to 1.5 pixels outside the smaller ball.
    let pixels = |radius: f32| 400.0 * radius / libm::sqrtf(16.0 - radius * radius);
    let disc = |radius: f32| core::f32::consts::PI * radius * radius;
    let found = area(0.5);
    let (least, most) =
        (disc(pixels(0.6) - 1.5) - disc(pixels(0.5) + 2.0), disc(pixels(0.6) - 1.5) - disc(pixels(0.5) + 0.5));
    assert!((least..most).contains(&found), "{found}, not between {least} and {most}");
    let length = contour_length(silhouette) as f32;
    let expected = core::f32::consts::TAU * pixels(0.6);
    assert!((length / expected - 1.0).abs() < 0.05, "{length}, not {expected}");
    coverage.draw(&sphere(Vec3::ZERO, 0.5), &camera);
    assert!(coverage.uncovered_rim(silhouette) > 0.95);
}

/// Two silhouettes lack what the other four show. If all masks are known to be too narrow, only what is deeper counts.
#[test]
fn masks_that_are_all_too_narrow_contradict_nobody_for_that_alone() {
    let found = |shown: f32, left: f32, edge: Option<ContourEdge>| {
        let view = |(place, from): (u16, Vec3)| {
            let radius = if place < 4 { shown } else { left };
            View { edge, ..silhouette_of(&[(Vec3::ZERO, radius)], &pinhole(from, Vec3::ZERO, 200, 300.0), place) }
        };
        let views: Vec<View> = (0..).zip(ring(6, 4.0, 1.0)).map(view).collect();
        let mesh = sphere(Vec3::ZERO, left);
        let found = contradicting(&views, &mesh, AgreementParams::BLAME, &mut Workspace::default(), &Serial, &Silent);
        let mut places = found.expect("nobody cancels").places;
        places.sort_unstable();
        places
    };
    let narrow = Some(ContourEdge { moved: -6.0, far: [0.0, 0.9], ..ContourEdge::default() });
    // The radii differ by 5 and by 24 pixels.
    assert_eq!(found(0.5, 0.43, None), [4, 5]);
    assert!(found(0.5, 0.43, narrow).is_empty());
    assert_eq!(found(0.8, 0.5, narrow), [4, 5]);
}

/// Four silhouettes show more than the other two leave. If they do not follow their pictures, the two are not to blame.
#[test]
fn a_silhouette_that_does_not_follow_its_picture_accuses_nobody() {
    let mut views: Vec<View> = (0..)
        .zip(ring(6, 4.0, 1.0))
        .map(|(place, from)| {
            let radius = if place < 4 { 0.8 } else { 0.5 };
            silhouette_of(&[(Vec3::ZERO, radius)], &pinhole(from, Vec3::ZERO, 200, 300.0), place)
        })
        .collect();
    let found = |views: &[View]| {
        let mesh = sphere(Vec3::ZERO, 0.5);
        let found = contradicting(views, &mesh, AgreementParams::BLAME, &mut Workspace::default(), &Serial, &Silent);
        let mut places = found.expect("nobody cancels").places;
        places.sort_unstable();
        places
    };
    assert_eq!(found(&views), [4, 5]);
    let strange = ContourEdge { usual: 0.9, ..ContourEdge::default() };
    views[..4].iter_mut().for_each(|view| view.edge = Some(strange));
    assert!(found(&views).is_empty());
}
