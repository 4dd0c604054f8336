//! Epipolar tangency: a plane through two cameras that touches the body projects to a tangent of both silhouettes, so
//! that the two points of tangency are the same point of the surface, a frontier point (Cipolla, Åström and Giblin,
//! Motion from the Frontier of Curved Surfaces, ICCV 1995). This needs no texture and no search: it holds however far
//! the calibration is off.

use super::{
    model::Model,
    outline::Corner,
    track::{Observation, Source, Track, is_held_out},
};
use alloc::{vec, vec::Vec};
use glam::{DVec2, DVec3};

/// Least cosine between a ray of the silhouette and the direction from which its tangents are measured. Beyond it the
/// epipole is too near, or within the silhouette, where no plane touches.
const LEAST_COSINE: f64 = 0.35;
/// Cosine of the least and of the largest angle between two viewing rays: 8° and 150°.
const COSINES: [f64; 2] = [0.990, -0.866];

/// A pair of points of tangency.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tangency {
    /// Places of the two cameras.
    pub(super) cameras: [u16; 2],
    /// Ideal pixels of the points of tangency.
    pub(super) pixels: [DVec2; 2],
    /// Mean over both pictures of how far the tangent of the other one misses this one's, in pixels.
    pub(super) miss: f64,
    /// Whether it is not used to adjust the cameras but to judge them. It follows from the cameras and the end alone, so that
    /// it is the same for all poses.
    pub(super) held_out: bool,
}

/// The tangencies of all pairs of outlines of one frame. `outlines[k]` is that of the camera with place k; it is empty
/// if the camera has no silhouette.
pub(super) fn tangencies(models: &[Model], outlines: &[Vec<Corner>]) -> Vec<Tangency> {
    let mut found = Vec::new();
    for j in 1..models.len() {
        for i in 0..j {
            pair(models, outlines, [i, j], &mut found);
        }
    }
    found
}

/// The tangencies of one pair of cameras: at most two.
pub(super) fn pair(models: &[Model], outlines: &[Vec<Corner>], cameras: [usize; 2], found: &mut Vec<Tangency>) {
    let [a, b] = cameras.map(|i| &models[i]);
    let base = (b.centre() - a.centre()).normalize_or_zero();
    // The direction from a camera to the middle of its outline.
    let middle = |model: &Model, corners: &[Corner]| {
        let sum: DVec3 = corners.iter().map(|c| model.ray_of_ideal(c.pixel).normalize()).sum();
        sum.normalize_or_zero()
    };
    let [of_a, of_b] = cameras.map(|i| &outlines[i][..]);
    if of_a.len() < 3 || of_b.len() < 3 || base == DVec3::ZERO {
        return;
    }
    let (to_a, to_b) = (middle(a, of_a), middle(b, of_b));
    if !(to_a.dot(to_b) < COSINES[0] && to_a.dot(to_b) > COSINES[1]) {
        return;
    }
    // At a right angle to the base.
    let ahead = (to_a + to_b) - base * (to_a + to_b).dot(base);
    let ahead = ahead.normalize_or_zero();
    let up = base.cross(ahead);
    let (Some(ends_a), Some(ends_b)) = (ends(a, of_a, ahead, up), ends(b, of_b, ahead, up)) else { return };
    let [i, j] = cameras;
    let number = 2 * (j * j.saturating_sub(1) / 2 + i);
    for (end, (end_a, end_b)) in ends_a.into_iter().zip(ends_b).enumerate() {
        let (Some(end_a), Some(end_b)) = (end_a, end_b) else { continue };
        let (p, q) = (of_a[end_a], of_b[end_b]);
        let miss_b = b.ideal_epipolar_distance(q.pixel, a.centre(), a.ray_of_ideal(p.pixel));
        let miss_a = a.ideal_epipolar_distance(p.pixel, b.centre(), b.ray_of_ideal(q.pixel));
        let miss = 0.5 * (miss_a.abs() + miss_b.abs());
        let held_out = is_held_out(number + end);
        found.push(Tangency { cameras: cameras.map(|i| i as u16), pixels: [p.pixel, q.pixel], miss, held_out });
    }
}

/// The corners with the smallest and the largest slope of their plane through the base, or none at an end near which the
/// silhouette is cut off: the body may go on there. `None` if some plane is too steep.
fn ends(model: &Model, corners: &[Corner], ahead: DVec3, up: DVec3) -> Option<[Option<usize>; 2]> {
    let mut slopes = Vec::with_capacity(corners.len());
    for corner in corners {
        let ray = model.ray_of_ideal(corner.pixel);
        let along = ray.dot(ahead);
        if !(along > LEAST_COSINE * ray.length()) {
            return None;
        }
        slopes.push(ray.dot(up) / along);
    }
    let first = |is_better: &dyn Fn(f64, f64) -> bool| {
        (0..slopes.len()).reduce(|best, i| if is_better(slopes[i], slopes[best]) { i } else { best })
    };
    let (least, most) = (first(&|a, b| a < b)?, first(&|a, b| a > b)?);
    let middle = 0.5 * (slopes[least] + slopes[most]);
    let cut = |upper: bool| corners.iter().zip(&slopes).any(|(c, &slope)| !c.is_contour && (slope > middle) == upper);
    Some([(!cut(false)).then_some(least), (!cut(true)).then_some(most)])
}

/// The median miss over the tangencies of each camera, in pixels; `None` for fewer than four.
pub(super) fn misses(cameras: usize, tangencies: &[Tangency]) -> Vec<Option<f64>> {
    let mut of: Vec<Vec<f64>> = vec![Vec::new(); cameras];
    for t in tangencies {
        t.cameras.iter().for_each(|&c| of[c as usize].push(t.miss));
    }
    of.into_iter()
        .map(|mut misses| if misses.len() < 4 { None } else { super::statistics::median(&mut misses) })
        .collect()
}

/// The tangencies as tracks of two observations.
pub(super) fn tracks(models: &[Model], tangencies: &[Tangency], sigma: f64) -> Vec<Track> {
    let mut tracks = Vec::new();
    for t in tangencies {
        let observation = |k: usize| Observation {
            camera: t.cameras[k],
            pixel: models[t.cameras[k] as usize].real_of_ideal(t.pixels[k]),
            sigma,
        };
        let mut track = Track {
            observations: vec![observation(0), observation(1)],
            point: DVec3::ZERO,
            source: Source::Contour,
            held_out: false,
        };
        if track.triangulate(models, 1e3) {
            tracks.push(track);
        }
    }
    tracks
}
