//! Eq. 1 of §4.1: which samples a view supports, and what the sum of the views makes of it.

use super::super::{
    sweep::{TILE, TILE_PIXELS},
    vote::{Curves, Support, VoteParams, deviation},
};
use crate::testing::law;
use alloc::{vec, vec::Vec};
use core::slice;
use proptest::prelude::*;
use studio::noise::Random;

/// Eq. 1 as printed, without smoothing.
const PRINTED: VoteParams = VoteParams { smoothing: None, support: Support::Peaks, agreement_radius: None };
/// Every peak spread by a kernel.
const PARZEN: VoteParams = VoteParams { support: Support::SpreadPeaks(1.0), ..PRINTED };
/// Plain sums of scores.
const SUM: VoteParams = VoteParams { support: Support::Scores, ..PRINTED };

const PIXEL: usize = 5 * TILE + 9;

/// The votes of views with the given curves, which are the same at every pixel.
fn votes(params: &VoteParams, views: &[Vec<f32>]) -> Curves {
    let mut curves = Curves::default();
    curves.tune(params);
    curves.reset(views[0].len());
    for view in views {
        for (scores, &score) in curves.scores_mut().iter_mut().zip(view) {
            *scores = [score; TILE_PIXELS];
        }
        curves.vote(params);
    }
    curves
}

/// Support of each sample of a pixel.
fn support(curves: &Curves, pixel: usize, count: usize) -> Vec<f32> {
    (0..count).map(|i| curves.best(pixel, i, i, false).1).collect()
}

/// A curve with a peak of a given height and width at a place between samples.
fn bell(count: usize, height: f32, place: f32, width: f32) -> Vec<f32> {
    let at = |i| (i as f32 - place) / width;
    (0..count).map(|i| height * libm::expf(-0.5 * at(i) * at(i))).collect()
}

/// A view that something hides at the surface: its score rises to what hides it, beyond the range.
fn occluded(count: usize) -> Vec<f32> {
    (0..count).map(|i| 0.95 - 0.08 * i as f32).collect()
}

#[test]
fn a_view_votes_where_its_curve_peaks_and_nowhere_else() {
    // A peak, a flat top, a peak below zero, a shoulder, a peak, and a rise into the end.
    let curve = vec![0.1, 0.6, 0.2, 0.5, 0.5, -0.4, -0.2, -0.3, 0.2, 0.3, 0.7, 0.65, 0.64, 0.9];
    let mut expected = vec![0.0; curve.len()];
    (expected[1], expected[10]) = (0.6, 0.7);
    assert_eq!(support(&votes(&PRINTED, slice::from_ref(&curve)), PIXEL, curve.len()), expected);
    // Of several views the votes add up, in each sample by itself.
    let twice = expected.iter().map(|v| v + v).collect::<Vec<_>>();
    assert_eq!(support(&votes(&PRINTED, &[curve.clone(), curve.clone()]), PIXEL, curve.len()), twice);
}

#[test]
fn an_occluded_view_abstains() {
    const COUNT: usize = 20;
    let seeing = [bell(COUNT, 0.8, 12.2, 1.5), bell(COUNT, 0.7, 11.9, 1.3), bell(COUNT, 0.6, 12.1, 2.0)];
    let with: Vec<_> = seeing.iter().cloned().chain([(); 3].map(|()| occluded(COUNT))).collect();
    for params in [PRINTED, PARZEN] {
        let (without, with) = (votes(&params, &seeing), votes(&params, &with));
        assert_eq!(support(&with, PIXEL, COUNT), support(&without, PIXEL, COUNT));
        let (place, _) = with.best(PIXEL, 1, COUNT - 2, true);
        assert!((place - 12.05).abs() < 0.2, "{place}");
    }
    // The case is not harmless: plain sums follow the hidden views.
    assert_eq!(votes(&SUM, &with).best(PIXEL, 1, COUNT - 2, false).0, 1.0);
}

/// Four views whose peaks scatter by half the kernel's width or more: the error that the support predicts is the one that
/// is made.
#[test]
fn the_support_tells_the_error_of_the_best_sample() {
    const COUNT: usize = 25;
    const VIEWS: usize = 4;
    const PLACE: f32 = 12.3;
    let mut random = Random::new(7, 0);
    for (width, scatter) in [1.0, 2.0].into_iter().flat_map(|width| [0.5, 0.8, 1.0].map(|share| (width, share * width)))
    {
        let params = VoteParams { support: Support::SpreadPeaks(width), ..PRINTED };
        let mut curves = Curves::default();
        curves.tune(&params);
        curves.reset(COUNT);
        for _ in 0..VIEWS {
            for pixel in 0..TILE_PIXELS {
                let bell = bell(COUNT, 1.0, PLACE + scatter * random.normal() as f32, 1.5);
                curves.scores_mut().iter_mut().zip(bell).for_each(|(scores, score)| scores[pixel] = score);
            }
            curves.vote(&params);
        }
        let (mut made, mut predicted) = (0.0, 0.0);
        for pixel in 0..TILE_PIXELS {
            let (place, support) = curves.best(pixel, 1, COUNT - 2, true);
            let sigma = deviation(support / VIEWS as f32, VIEWS as f32, params.support);
            (made, predicted) = (made + (place - PLACE) * (place - PLACE), predicted + sigma * sigma);
        }
        let ratio = libm::sqrtf(predicted / made);
        assert!((0.7..1.5).contains(&ratio), "width {width}, scatter {scatter}: {ratio} of the error is predicted");
    }
}

#[test]
fn peaks_one_sample_apart_support_each_other_only_when_spread() {
    const COUNT: usize = 12;
    let tent = |peak: usize| (0..COUNT).map(|i| 0.8 - 0.3 * i.abs_diff(peak) as f32).collect::<Vec<f32>>();
    let views = [tent(5), tent(6)];
    let printed = support(&votes(&PRINTED, &views), PIXEL, COUNT);
    assert_eq!((printed[5], printed[6]), (0.8, 0.8));
    // A kernel of one sample's deviation is e^(-1/2) at the next sample.
    let spread = support(&votes(&PARZEN, &views), PIXEL, COUNT);
    for i in [5, 6] {
        assert!((spread[i] - 0.8 * (1.0 + libm::expf(-0.5))).abs() < 1e-6, "{}", spread[i]);
    }
    // So two views that nearly agree outweigh one that scores higher elsewhere.
    let views = [tent(5), tent(6), bell(COUNT, 0.95, 2.0, 0.6)];
    assert_eq!(votes(&PRINTED, &views).best(PIXEL, 1, COUNT - 2, false).0, 2.0);
    let (place, _) = votes(&PARZEN, &views).best(PIXEL, 1, COUNT - 2, true);
    assert!((place - 5.5).abs() < 0.51, "{place}");
}

#[test]
fn a_parabolas_vertex_is_found_between_the_samples() {
    const COUNT: usize = 11;
    for place in [4.51, 4.6, 4.75, 5.0, 5.1, 5.32, 5.49] {
        let parabola = |steep: f32| -> Vec<f32> {
            (0..COUNT).map(|i| 0.9 - steep * (i as f32 - place) * (i as f32 - place)).collect()
        };
        let views = [parabola(0.02), parabola(0.11)];
        let (found, _) = votes(&SUM, &views).best(PIXEL, 1, COUNT - 2, true);
        assert!((found - place).abs() < 1e-4, "{found} instead of {place}");
        // A kernel sits at the vertex to 1/64 sample; the parabola through its samples errs by a twentieth at most.
        let (found, _) = votes(&PARZEN, &views).best(PIXEL, 1, COUNT - 2, true);
        assert!((found - place).abs() < 0.07, "{found} instead of {place}");
        let (found, _) = votes(&SUM, &views).best(PIXEL, 1, COUNT - 2, false);
        assert_eq!(found, libm::roundf(place), "whole samples unless refined");
    }
}

#[test]
fn smoothing_makes_one_peak_of_a_ragged_one_and_keeps_the_level() {
    const COUNT: usize = 24;
    let smoothing = VoteParams { smoothing: Some(1.0), ..PRINTED };
    let level = |params: &VoteParams| support(&votes(params, &[vec![0.4; COUNT]]), PIXEL, COUNT);
    for v in level(&VoteParams { support: Support::Scores, ..smoothing }) {
        assert!((v - 0.4).abs() < 1e-6, "{v}");
    }
    let ragged: Vec<f32> =
        bell(COUNT, 0.8, 11.0, 4.0).iter().zip([0.1, -0.1].iter().cycle()).map(|(b, r)| b + r).collect();
    let peaks = |params: &VoteParams| -> Vec<usize> {
        let support = support(&votes(params, slice::from_ref(&ragged)), PIXEL, COUNT);
        (0..COUNT).filter(|&i| support[i] > 0.0).collect()
    };
    assert!(peaks(&PRINTED).len() > 6, "{:?}", peaks(&PRINTED));
    assert_eq!(peaks(&smoothing), [11]);
}

#[test]
fn pixels_that_are_not_searched_do_not_weaken_their_neighbours() {
    const COUNT: usize = 7;
    let mut curves = votes(&PRINTED, &[bell(COUNT, 0.8, 3.0, 1.0)]);
    let mut searched = [true; TILE_PIXELS];
    searched.iter_mut().step_by(3).for_each(|s| *s = false);
    curves.agree(2, &searched);
    for pixel in (0..TILE_PIXELS).filter(|&p| searched[p]) {
        let (place, support) = curves.best(pixel, 1, COUNT - 2, false);
        assert!(place == 3.0 && (support - 0.8).abs() < 1e-6, "pixel {pixel}: {support} at {place}");
    }
}

#[test]
fn of_hypotheses_with_equal_support_the_nearest_is_taken() {
    let curve: Vec<f32> = (0..12).map(|i| if i == 3 || i == 8 { 0.8 } else { 0.1 }).collect();
    for params in [PRINTED, PARZEN] {
        assert_eq!(votes(&params, slice::from_ref(&curve)).best(PIXEL, 1, 10, false).0, 3.0);
    }
}

/// The fidelity is bounded by the number of views for peaks as printed only.
#[test]
fn spread_peaks_of_one_view_add_up_to_more_than_one() {
    // Two peaks two hypotheses apart. The hypothesis between them gets e^(-1/2) of each.
    let curve = vec![-1.0, -1.0, 1.0, -1.0, 1.0, -1.0, -1.0];
    let fidelity = |params: &VoteParams| votes(params, slice::from_ref(&curve)).best(PIXEL, 1, 5, false).1;
    assert_eq!(fidelity(&PRINTED), 1.0);
    assert!((fidelity(&PARZEN) - 2.0 * libm::expf(-0.5)).abs() < 1e-6, "{}", fidelity(&PARZEN));
}

proptest! {
    #![proptest_config(law(200))]

    /// As printed, every view adds at most one, and all of them add that much where all are sure.
    #[test]
    fn fidelity_is_at_most_the_number_of_views(
        views in (3..30usize).prop_flat_map(|n| prop::collection::vec(prop::collection::vec(-1.0..=1.0f32, n), 1..6)),
        smoothing in prop::option::of(0.3..2.0f32),
    ) {
        let count = views[0].len();
        let (_, fidelity) = votes(&VoteParams { smoothing, ..PRINTED }, &views).best(PIXEL, 1, count - 2, true);
        prop_assert!((0.0..=views.len() as f32 + 1e-5).contains(&fidelity), "{fidelity} of {} views", views.len());
        let mut sure = vec![-1.0; count];
        sure[count / 2] = 1.0;
        let curves = votes(&PARZEN, &vec![sure; views.len()]);
        prop_assert_eq!(curves.best(PIXEL, 1, count - 2, false), ((count / 2) as f32, views.len() as f32));
    }

    /// The best sample does not depend on the order in which the views vote, but for rounding.
    #[test]
    fn the_order_of_the_views_does_not_matter(
        views in prop::collection::vec(prop::collection::vec(-1.0..=1.0f32, 16), 2..6),
        spread in prop::option::of(0.3..2.0f32),
    ) {
        let params = VoteParams { support: spread.map_or(Support::Peaks, Support::SpreadPeaks), ..PRINTED };
        let mut reversed = views.clone();
        reversed.reverse();
        let [a, b] = [views, reversed].map(|views| support(&votes(&params, &views), PIXEL, 16));
        for (a, b) in a.iter().zip(b) {
            prop_assert!((a - b).abs() < 1e-5, "{a} and {b}");
        }
    }
}
