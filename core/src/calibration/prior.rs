//! How far the cameras may be from the given ones: the priors of the adjustment, and their estimate from the corrections
//! that have been found so far.

use super::{
    adjust::Priors,
    model::{FOCAL, Model, PARAMETERS, SHIFT},
    statistics::median,
};
use alloc::vec::Vec;

/// Prior standard deviations of the focal length as a share of it, and of the principal point in pixels.
const FOCAL_SHARE: f64 = 0.003;
const PRINCIPAL_PIXELS: f64 = 3.0;
/// Bounds of the standard deviations that are estimated, in pixels.
const AIM_BOUNDS: [f64; 2] = [0.05, 5.0];
const SHIFT_BOUNDS: [f64; 2] = [0.02, 3.0];
/// Matches share errors that do not average out: of interpolation, of the surface's shape, of the lens model. All evidence
/// together is therefore worth less than single matches suggest, by this factor in standard deviations. The priors are
/// narrower by it instead, which is the same.
pub(super) const SHARED: f64 = 2.0;
/// A correction that is this many times the usual one is the camera's own.
const OWN: f64 = 3.0;

/// The standard deviations of one camera's error, in pixels at the object.
///
/// A turn and a shift look nearly alike at the object. What calibrations get wrong is therefore described by how far the
/// camera's aim is off, which both add up to, and by how much of that is a shift of its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spread {
    /// Of the picture of the origin, and of the roll.
    pub(super) aim: f64,
    /// Of the centre, in footprints. With zero it does not move.
    pub(super) shift: f64,
}

/// A camera's correction in pixels at the object.
struct Correction {
    /// Movement of the picture of the origin, and the roll at a quarter of the picture's width from the middle.
    aim: [f64; 3],
    /// Shift of the centre.
    shift: [f64; 3],
}

/// Footprint at the origin.
fn footprint(model: &Model) -> f64 {
    model.centre().length() / model.focal()
}

/// The rows that map a deviation of a camera's extrinsic parameters to its [`Correction`].
fn aim_rows(model: &Model) -> [[f64; FOCAL]; 3] {
    let (focal, shift) = (model.focal(), 1.0 / footprint(model));
    [
        [0.0, focal, 0.0, shift, 0.0, 0.0],
        [-focal, 0.0, 0.0, 0.0, shift, 0.0],
        [0.0, 0.0, 0.25 * model.width(), 0.0, 0.0, 0.0],
    ]
}

impl Correction {
    fn new(given: &Model, model: &Model) -> Self {
        let deviation = model.deviation(given);
        let aim = aim_rows(given).map(|row| row.iter().zip(deviation).map(|(a, b)| a * b).sum());
        let unit = footprint(given);
        Self { aim, shift: core::array::from_fn(|k| deviation[SHIFT + k] / unit) }
    }
}

impl Spread {
    /// What is assumed before anything has been found.
    pub(super) const FIRST: Self = Self { aim: 3.0, shift: 1.0 };

    /// The priors of the cameras' parameters. With `intrinsics` the focal length and the principal point are free.
    pub(super) fn priors(given: &[Model], spreads: &[Self], intrinsics: bool) -> Priors {
        let information = given.iter().zip(spreads).map(|(model, spread)| spread.information(model, intrinsics));
        Priors { given: given.to_vec(), information: information.collect() }
    }

    fn information(&self, model: &Model, intrinsics: bool) -> [[f64; PARAMETERS]; PARAMETERS] {
        let mut information = [[0.0; PARAMETERS]; PARAMETERS];
        let free = if self.shift > 0.0 { FOCAL } else { SHIFT };
        for row in aim_rows(model) {
            for k in 0..free {
                for l in 0..free {
                    information[k][l] += row[k] * row[l] / (self.aim * self.aim);
                }
            }
        }
        let shift = self.shift * footprint(model);
        for k in SHIFT..free {
            information[k][k] += 1.0 / (shift * shift);
        }
        if intrinsics {
            information[FOCAL][FOCAL] = 1.0 / (FOCAL_SHARE * FOCAL_SHARE);
            for k in FOCAL + 1..PARAMETERS {
                information[k][k] = 1.0 / (PRINCIPAL_PIXELS * PRINCIPAL_PIXELS);
            }
        }
        information
    }
}

/// The spread of each camera's error, from the corrections that have been found, narrower by [`SHARED`].
///
/// A correction that all cameras share, such as a pitch of the whole ring, moves the object and hardly changes how well
/// the cameras agree. Priors that are no wider than the corrections differ keep it small, so that the world stays in place.
pub(super) fn spreads(given: &[Model], models: &[Model]) -> Vec<Spread> {
    let corrections: Vec<Correction> = given.iter().zip(models).map(|(a, b)| Correction::new(a, b)).collect();
    let middle: [f64; 3] = core::array::from_fn(|k| {
        let mut all: Vec<f64> = corrections.iter().map(|of| of.aim[k]).collect();
        median(&mut all).unwrap_or(0.0)
    });
    let size = |of: [f64; 3]| libm::sqrt(of.iter().map(|v| v * v).sum::<f64>() / 3.0);
    let aims = corrections.iter().map(|of| size(core::array::from_fn(|k| of.aim[k] - middle[k])));
    let (aims, shifts) = (aims.collect(), corrections.iter().map(|of| size(of.shift)).collect());
    let (aims, shifts) = (with_own(aims, AIM_BOUNDS), with_own(shifts, SHIFT_BOUNDS));
    aims.into_iter().zip(shifts).map(|(aim, shift)| Spread { aim: aim / SHARED, shift: shift / SHARED }).collect()
}

/// The usual size for each camera, except for those whose own is much larger.
fn with_own(sizes: Vec<f64>, [least, most]: [f64; 2]) -> Vec<f64> {
    let usual = median(&mut sizes.clone()).unwrap_or(least).clamp(least, most);
    sizes.into_iter().map(|own| if own > OWN * usual { own } else { usual }).collect()
}
