//! How well cameras agree with matches and contours.

use super::{
    instant::Instant,
    model::Model,
    statistics::{median, robust_sigma},
    tangents::{Tangency, misses, tangencies},
    track::{Source, Track},
};
use alloc::{vec, vec::Vec};

/// Matches per camera below which no residual is given.
const LEAST_MATCHES: usize = 12;
/// Scale in standard deviations of the loss by which matches judge a calibration.
const JUDGE: f64 = 2.0;

/// Residuals of one camera.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residuals {
    /// Median distance in pixels by which the tangents from other silhouettes miss this camera's silhouette. `None` if
    /// there are too few: no silhouette, or one that the picture cuts off.
    pub contour_px: Option<f64>,
    /// Median distance in pixels of matches from their epipolar lines, over the matches of this camera with others.
    /// `None` if there are too few.
    pub epipolar_px: Option<f64>,
    /// Robust standard deviation of these distances about their median for each pair of cameras, in pixels: how precise
    /// single matches are, whatever the calibration is.
    pub noise_px: Option<f64>,
    /// Number of matches of this camera with others.
    pub matches: u32,
}

/// Calls `f` with the places of both cameras, and the signed distance in pixels of each match from its epipolar line in
/// the second one.
fn distances(models: &[Model], tracks: &[Track], mut f: impl FnMut([u16; 2], f64, bool)) {
    for track in tracks.iter().filter(|track| track.source == Source::Texture) {
        let Some((own, others)) = track.observations.split_first() else { continue };
        let a = &models[own.camera as usize];
        for seen in others {
            let b = &models[seen.camera as usize];
            let there = b.epipolar_distance(seen.pixel, a.centre(), a.ray(own.pixel));
            let here = a.epipolar_distance(own.pixel, b.centre(), b.ray(seen.pixel));
            if there.is_finite() && here.is_finite() {
                f([own.camera, seen.camera], there, track.held_out);
                f([seen.camera, own.camera], here, track.held_out);
            }
        }
    }
}

/// The tangencies of all frames.
pub(super) fn all_tangencies(instants: &[Instant], models: &[Model]) -> Vec<Tangency> {
    instants.iter().flat_map(|instant| tangencies(models, &instant.outlines)).collect()
}

/// The residuals of each camera, by place.
pub(super) fn residuals(instants: &[Instant], models: &[Model], tracks: &[Track]) -> Vec<Residuals> {
    let count = models.len();
    let contours = misses(count, &all_tangencies(instants, models));
    // By pair, so that noise can be told from bias.
    let mut pairs: Vec<Vec<f64>> = vec![Vec::new(); count * count];
    distances(models, tracks, |[a, b], d, _| pairs[usize::from(b) * count + usize::from(a)].push(d));
    (0..count)
        .map(|camera| {
            let (mut all, mut noise) = (Vec::new(), Vec::new());
            for of_pair in &mut pairs[camera * count..][..count] {
                if let Some(middle) = median(of_pair) {
                    all.extend(of_pair.iter().map(|d| d.abs()));
                    noise.extend(of_pair.iter().map(|d| d - middle));
                }
            }
            let enough = all.len() >= LEAST_MATCHES;
            Residuals {
                contour_px: contours[camera],
                epipolar_px: if enough { median(&mut all) } else { None },
                noise_px: if enough { robust_sigma(&noise) } else { None },
                matches: all.len() as u32,
            }
        })
        .collect()
}

/// The mean loss of what was held out, or `None` if too little was. `sigmas` are the standard deviations in pixels of
/// matches and of tangencies.
pub(super) fn held_out_loss(instants: &[Instant], models: &[Model], tracks: &[Track], sigmas: [f64; 2]) -> Option<f64> {
    let loss = |d: f64, sigma: f64| libm::log1p(d * d / (sigma * sigma * JUDGE * JUDGE));
    let (mut sum, mut count) = (0.0, 0_u32);
    distances(models, tracks, |_, d, held_out| {
        if held_out {
            sum += loss(d, sigmas[0]);
            count += 1;
        }
    });
    for instant in instants {
        for tangency in tangencies(models, &instant.outlines).iter().filter(|tangency| tangency.held_out) {
            sum += loss(tangency.miss, sigmas[1]);
            count += 1;
        }
    }
    (count as usize >= models.len()).then(|| sum / f64::from(count))
}

/// The mean over all pairs of cameras of the size of their median signed distance, in pixels: what calibration, not
/// chance, is off by. `None` if fewer than `least` cameras, counted once for each of their pairs, have matches enough.
pub(super) fn epipolar_bias(models: &[Model], tracks: &[Track], least: usize) -> Option<f64> {
    let count = models.len();
    let mut pairs: Vec<Vec<f64>> = vec![Vec::new(); count * count];
    distances(models, tracks, |[a, b], d, _| pairs[usize::from(b) * count + usize::from(a)].push(d));
    let mut sizes = Vec::new();
    for of_pair in pairs.iter_mut().filter(|of_pair| of_pair.len() >= LEAST_MATCHES) {
        sizes.extend(median(of_pair).map(f64::abs));
    }
    (sizes.len() >= least).then(|| sizes.iter().sum::<f64>() / sizes.len() as f64)
}
