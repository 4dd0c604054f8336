use super::{
    coverage::{Coverage, PIXELS_PER_SAMPLE, contour_length},
    excluders::{Excluders, Sets},
    verdict::Verdict,
};
use crate::testing::{pinhole, silhouette_of, sphere};
use alloc::vec::Vec;
use glam::Vec3;

const NONE: u16 = u16::MAX;

fn said(statements: &[(u16, f32, &[Excluders])]) -> Verdict {
    let mut verdict = Verdict::new(8);
    for &(from, weight, sets) in statements {
        let mut all = Sets::new();
        sets.iter().for_each(|&set| all.add(set));
        verdict.record(from, weight, all);
    }
    verdict
}

/// The two loudest accusers do not count: with two there is nothing, with four there is what the other two say.
#[test]
fn two_views_accuse_nobody() {
    let set: &[Excluders] = &[[7, NONE, NONE]];
    let two = said(&[(0, 100.0, set), (1, 100.0, set)]);
    assert!(two.guilty(1.0, 8).is_empty());
    let four = said(&[(0, 100.0, set), (1, 100.0, set), (2, 5.0, set), (3, 4.0, set)]);
    assert_eq!(four.guilty(9.0, 8), [7]);
    assert!(four.guilty(9.5, 8).is_empty());
}

/// Of several places on a ray the one that fewest views exclude counts.
#[test]
fn the_most_plausible_place_counts() {
    let sets: &[Excluders] = &[[5, 6, NONE], [7, NONE, NONE]];
    let verdict = said(&[(0, 10.0, sets), (1, 10.0, sets), (2, 10.0, sets)]);
    assert_eq!(verdict.guilty(10.0, 8), [7]);
}

/// What a view at fault explains is not held against others, and what remains falls on the other view of a pair.
#[test]
fn what_is_explained_is_not_held_against_others() {
    let (shared, alone): (&[Excluders], &[Excluders]) = (&[[6, 7, NONE]], &[[7, NONE, NONE]]);
    let mut statements: Vec<(u16, f32, &[Excluders])> = (0..5).map(|from| (from, 20.0, alone)).collect();
    statements.extend((0..5).map(|from| (from, 6.0, shared)));
    // Against 7 there are 3 · (20 + 3) pixels. Without it, 3 · 6 are held against 6 alone.
    assert_eq!(said(&statements).guilty(18.0, 8), [7, 6]);
    assert_eq!(said(&statements).guilty(18.5, 8), [7]);
    let either: &[Excluders] = &[[6, NONE, NONE], [7, NONE, NONE]];
    let statements: Vec<(u16, f32, &[Excluders])> =
        (0..5).flat_map(|from| [(from, 20.0, alone), (from, 6.0, either)]).collect();
    assert_eq!(said(&statements).guilty(1.0, 8), [7], "explained by the view at fault");
}

/// A view at fault is no witness, and there are not more than asked for.
#[test]
fn views_at_fault_are_not_heard() {
    let (against_7, against_6): (&[Excluders], &[Excluders]) = (&[[7, NONE, NONE]], &[[6, NONE, NONE]]);
    let mut statements: Vec<(u16, f32, &[Excluders])> = (0..4).map(|from| (from, 50.0, against_7)).collect();
    statements.extend([(7, 90.0, against_6), (0, 10.0, against_6), (1, 10.0, against_6)]);
    assert_eq!(said(&statements).guilty(9.0, 8), [7], "without 7 only two views accuse 6");
    assert!(said(&statements).guilty(9.0, 0).is_empty());
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
        coverage.uncovered(silhouette).len() as f32 * PIXELS_PER_SAMPLE
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
