//! Points that several cameras see, with where they see them.

use super::model::Model;
use alloc::vec::Vec;
use glam::{DMat3, DVec2, DVec3};

/// What a track was found by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Source {
    /// Matching of texture.
    Texture,
    /// Tangency of contours to a plane through both cameras.
    Contour,
}

/// Where one camera sees a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Observation {
    /// Place of the camera in the rig's order.
    pub(super) camera: u16,
    /// Pixel of the real picture.
    pub(super) pixel: DVec2,
    /// Standard deviation in pixels.
    pub(super) sigma: f64,
}

/// One point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Track {
    pub(super) observations: Vec<Observation>,
    /// Position relative to the rig's origin.
    pub(super) point: DVec3,
    pub(super) source: Source,
    /// Whether the track is kept out of the adjustment, to judge its result.
    pub(super) held_out: bool,
}

/// Newton steps of the triangulation.
const STEPS: usize = 4;

/// One of so many tracks is held out: it does not adjust the cameras but judges them.
const HELD_OUT: usize = 5;

/// Whether the track with this number is held out. Numbers belong to what is seen, not to what was found, so that a track is
/// held out in all rounds or in none.
pub(super) fn is_held_out(number: usize) -> bool {
    number % HELD_OUT == HELD_OUT - 1
}

impl Track {
    /// Places the point where its rays meet best: the point nearest to all rays, then a few steps that make the
    /// residuals in the pictures small. Returns false if the rays do not meet in front of the cameras.
    pub(super) fn triangulate(&mut self, models: &[Model], scale: f64) -> bool {
        let (mut a, mut b) = (DMat3::ZERO, DVec3::ZERO);
        for seen in &self.observations {
            let model = &models[seen.camera as usize];
            let d = model.ray(seen.pixel).normalize();
            let across = DMat3::IDENTITY - DMat3::from_cols(d * d.x, d * d.y, d * d.z);
            a += across;
            b += across * model.centre();
        }
        if !(a.determinant() > 1e-9) {
            return false;
        }
        let mut point = a.inverse() * b;
        for _ in 0..STEPS {
            let (mut a, mut b) = (DMat3::ZERO, DVec3::ZERO);
            for seen in &self.observations {
                let Some(at) = models[seen.camera as usize].linearise(point) else { return false };
                let r = seen.pixel - at.pixel;
                let w = weight(r, seen.sigma, scale);
                let [jx, jy, jz] = at.by_point;
                let column = |j: DVec2| DVec3::new(jx.dot(j), jy.dot(j), jz.dot(j)) * w;
                a += DMat3::from_cols(column(jx), column(jy), column(jz));
                b += DVec3::new(jx.dot(r), jy.dot(r), jz.dot(r)) * w;
            }
            let step = a.inverse() * b;
            if !step.is_finite() {
                return false;
            }
            point += step;
        }
        self.point = point;
        self.observations.iter().all(|seen| models[seen.camera as usize].project(point).is_some())
    }
}

/// Weight of a residual under Cauchy's loss with a scale in standard deviations.
pub(super) fn weight(residual: DVec2, sigma: f64, scale: f64) -> f64 {
    let squared = residual.length_squared() / (sigma * sigma);
    1.0 / (sigma * sigma * (1.0 + squared / (scale * scale)))
}

/// Cauchy's loss of a residual.
pub(super) fn loss(residual: DVec2, sigma: f64, scale: f64) -> f64 {
    let squared = residual.length_squared() / (sigma * sigma);
    scale * scale * libm::log1p(squared / (scale * scale))
}

/// Loss of a point that an observing camera has behind it.
pub(super) fn worst_loss(scale: f64) -> f64 {
    scale * scale * libm::log1p(1e6 / (scale * scale))
}
