//! The gains against the same least-squares system solved by nalgebra, and against gains that are known.

use super::super::{
    candidate::Candidate,
    gains::{GainParams, Overlap},
};
use crate::{executor::Serial, workspace::Workspace};
use alloc::{collections::BTreeMap, vec::Vec};
use glam::Vec3;
use nalgebra::{DMatrix, DVector};
use studio::noise::Random;

const VIEWS: usize = 6;
/// Few enough that each is compared.
const VERTICES: usize = 900;

const PARAMS: GainParams = GainParams { min_score: 0.5, prior: 1.0 };

/// (vertex, view, colour).
type Seen = (usize, usize, Vec3);

fn solve(seen: &[Seen]) -> Vec<Vec3> {
    let workspace = &mut Workspace::default();
    let mut overlap = Overlap::new(VERTICES, VIEWS, workspace);
    for &(vertex, view, rgb) in seen {
        overlap.add(&[(vertex as u32, view as u16, rgb)]);
    }
    overlap.solve(&PARAMS, &Serial)
}

/// What cameras see of surfaces whose colours are random: each vertex is seen by three neighbours on a ring, and what a
/// camera sees is the surface's colour times `distort` of view and vertex.
fn seen(mut distort: impl FnMut(usize, usize) -> Vec3) -> Vec<Seen> {
    let mut random = Random::new(5, 0);
    let mut seen = Vec::new();
    for vertex in 0..VERTICES {
        let colour = Vec3::from_array(core::array::from_fn(|_| 60.0 + 80.0 * random.uniform() as f32));
        for k in 0..3 {
            let view = (vertex + k) % VIEWS;
            seen.push((vertex, view, colour * distort(view, vertex)));
        }
    }
    seen
}

/// What each camera multiplies red, green and blue by.
fn exposure(view: usize) -> Vec3 {
    let v = view as f32;
    Vec3::new(1.0 + 0.2 * libm::sinf(1.0 + v), 1.0 - 0.15 * libm::cosf(2.0 * v), 1.1 - 0.04 * v)
}

fn geometric_mean(values: impl Iterator<Item = f32>) -> f32 {
    libm::expf(values.map(libm::logf).sum::<f32>() / VIEWS as f32)
}

#[test]
fn known_gains_are_undone() {
    let gains = solve(&seen(|view, _| exposure(view)));
    for channel in 0..3 {
        // One gain per channel is free; the geometric mean of the answer is 1.
        let mean = geometric_mean((0..VIEWS).map(|v| exposure(v)[channel]));
        assert!((geometric_mean(gains.iter().map(|g| g[channel])) - 1.0).abs() < 1e-5);
        for view in 0..VIEWS {
            let expected = mean / exposure(view)[channel];
            // The pull of each gain towards one, as strong as one of some hundred vertices.
            assert!((gains[view][channel] / expected - 1.0).abs() < 3e-3, "{view}: {gains:?}");
        }
    }
}

/// Outliers, be they a third of what a pair of views shares, change nothing.
#[test]
fn highlights_do_not_count() {
    let mut random = Random::new(6, 0);
    let shines: Vec<bool> = (0..VERTICES).map(|_| random.uniform() < 0.3).collect();
    let dull = solve(&seen(|view, _| exposure(view)));
    // What shines does so towards every second camera.
    let bright = |view: usize, vertex: usize| if shines[vertex] && view.is_multiple_of(2) { 1.4 } else { 1.0 };
    let shiny = solve(&seen(|view, vertex| exposure(view) * bright(view, vertex)));
    for (a, b) in dull.iter().zip(&shiny) {
        assert!((*a / *b - 1.0).abs().max_element() < 2e-3, "{a} {b}");
    }
}

/// Colours that are too dark or too bright to trust, and views that see a vertex badly, are left out.
#[test]
fn what_is_not_trusted_does_not_count() {
    let good = seen(|view, _| exposure(view));
    let expected = solve(&good);
    let mut all = good.clone();
    // Vertices that no good observation uses, since they come in pairs of one view's neighbours far apart.
    for vertex in 0..VERTICES / 2 {
        let far = (vertex + 3) % VIEWS;
        all.push((vertex, far, Vec3::splat(if vertex % 2 == 0 { 5.0 } else { 254.0 })));
    }
    assert_eq!(solve(&all), expected);
    let workspace = &mut Workspace::default();
    let mut overlap = Overlap::new(VERTICES, VIEWS, workspace);
    for &(vertex, view, rgb) in &good {
        for (view, score, rgb) in [(view, 0.9, rgb), ((view + 3) % VIEWS, 0.4, Vec3::splat(100.0))] {
            let view = view as u16;
            if overlap.compares(vertex, &Candidate { score, view, rgb }, &PARAMS) {
                overlap.add(&[(vertex as u32, view, rgb)]);
            }
        }
    }
    assert_eq!(overlap.solve(&PARAMS, &Serial), expected);
}

/// The over-determined system, a row for each pair of views and one for each view's pull towards one, solved by SVD.
fn by_svd(seen: &[Seen], channel: usize) -> Vec<f64> {
    let mut ratios: BTreeMap<(usize, usize), Vec<f32>> = BTreeMap::new();
    for a in seen {
        for b in seen.iter().filter(|b| b.0 == a.0 && b.1 > a.1) {
            ratios.entry((a.1, b.1)).or_default().push(libm::logf(b.2[channel] / a.2[channel]));
        }
    }
    let rows = ratios.len() + VIEWS;
    let (mut matrix, mut right) = (DMatrix::<f64>::zeros(rows, VIEWS), DVector::<f64>::zeros(rows));
    for (row, ((i, j), mut logs)) in ratios.into_iter().enumerate() {
        logs.sort_by(f32::total_cmp);
        let weight = libm::sqrt(logs.len() as f64);
        (matrix[(row, i)], matrix[(row, j)]) = (weight, -weight);
        right[row] = weight * f64::from(logs[logs.len() / 2]);
    }
    for view in 0..VIEWS {
        matrix[(rows - VIEWS + view, view)] = 1.0;
    }
    let logs = matrix.svd(true, true).solve(&right, 1e-12).expect("both factors were asked for");
    let mean = logs.sum() / VIEWS as f64;
    logs.iter().map(|log| libm::exp(log - mean)).collect()
}

/// Observations that no gains explain, so that pairs of views contradict each other.
#[test]
fn gains_are_the_least_squares_solution() {
    let mut random = Random::new(7, 0);
    let mut noise = |scale: f32| 1.0 + scale * random.signed() as f32;
    let contradiction: Vec<Vec3> = (0..VIEWS * VIEWS).map(|_| Vec3::splat(noise(0.2))).collect();
    // The same camera sees different parts of the surface with different gains.
    let mut seen = seen(|view, vertex| exposure(view) * contradiction[view * VIEWS + vertex % VIEWS] * noise(0.1));
    // Not all pairs share as much as others.
    seen.retain(|&(vertex, view, _)| view != 2 || vertex % 5 == 0);
    let gains = solve(&seen);
    for channel in 0..3 {
        for (gain, expected) in gains.iter().zip(by_svd(&seen, channel)) {
            assert!((f64::from(gain[channel]) - expected).abs() < 1e-6, "{} {expected}", gain[channel]);
        }
    }
}

#[test]
fn cameras_that_share_nothing_keep_their_colours() {
    assert_eq!(solve(&[]), [Vec3::ONE; VIEWS]);
    let alone: Vec<Seen> = (0..VERTICES).map(|v| (v, v % VIEWS, Vec3::splat(40.0 + (v % VIEWS) as f32))).collect();
    assert_eq!(solve(&alone), [Vec3::ONE; VIEWS]);
}
