//! What is probably wrong with a camera that does not fit: where it stands, its focal length or the distortion of its lens.
//!
//! A wrong focal length looks much like a camera that is nearer or farther, but not quite: near and far parts of the object
//! grow by different factors if the camera moves, and by the same if the focal length changes. Matches are precise enough to
//! tell. The other cameras say where the matched points are. The camera is fitted to them with only one kind of error at a
//! time, and the kind that leaves clearly less than the others is the probable one.

use super::{
    adjust::{Priors, adjust},
    model::{FOCAL, Model, PARAMETERS},
    statistics::{median, robust_sigma},
    track::{Source, Track, weight},
};
use alloc::vec::Vec;
use glam::{DVec2, DVec3};
use nalgebra::{Cholesky, DMatrix, DVector};

/// What is probably wrong with a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cause {
    /// It stands or looks elsewhere than its calibration says.
    Pose,
    /// Its focal length is this many times the right one.
    FocalLength(f64),
    /// The distortion of its lens is another one, which moves what it sees by so many pixels: the root of the mean square.
    Distortion(f64),
    /// The matches do not tell.
    Unknown,
}

/// The kinds of error, each with the parameters that it changes. The last one is the lens.
const POSE: &[usize] = &[0, 1, 2, 3, 4, 5];
const ZOOM: &[usize] = &[FOCAL];
const LENS: &[usize] = &[DISTORTION];
const ALL: &[usize] = &[0, 1, 2, 3, 4, 5, FOCAL, DISTORTION];
/// The parameter of the lens: its first radial coefficient, k1.
const DISTORTION: usize = PARAMETERS;
/// The probable kind of error leaves less than this share of what the others leave,
const CLEARLY: f64 = 0.8;
/// and at most so many times what all kinds together leave.
const EXPLAINS: f64 = 1.5;
/// Fewest points that tell.
const FEWEST: usize = 50;
/// Scales of the loss in standard deviations: from gross errors to small ones.
const SCALES: [f64; 10] = [64.0, 32.0, 16.0, 8.0, 4.0, 3.0, 3.0, 3.0, 3.0, 3.0];
/// Least standard deviation in pixels of where a point is seen: that of points which the other cameras place.
const SIGMA: f64 = 0.1;
/// Steps of the parameters by which derivatives are measured.
const STEP: f64 = 1e-6;

/// A point that the other cameras have placed, and where the camera sees it.
struct Seen {
    point: DVec3,
    pixel: DVec2,
    sigma: f64,
}

/// What is probably wrong with the given camera at a place. `models` are the refined cameras.
pub(super) fn cause(given: &Model, place: usize, models: &[Model], tracks: &[Track]) -> Cause {
    let seen = seen(place, models, tracks);
    if seen.len() < FEWEST {
        return Cause::Unknown;
    }
    let [(_, pose), (zoomed, zoom), (bent, lens), (_, all)] =
        [POSE, ZOOM, LENS, ALL].map(|free| fitted(given, free, &seen));
    let is_cause =
        |own: f64, others: [f64; 2]| own < EXPLAINS * all && others.iter().all(|other| own < CLEARLY * other);
    if is_cause(pose, [zoom, lens]) {
        Cause::Pose
    } else if is_cause(zoom, [pose, lens]) {
        Cause::FocalLength(given.focal() / zoomed.focal())
    } else if is_cause(lens, [pose, zoom]) {
        Cause::Distortion(apart(given, &bent, &seen))
    } else {
        Cause::Unknown
    }
}

/// The points that a camera and at least two others see, as the others place them.
fn seen(place: usize, models: &[Model], tracks: &[Track]) -> Vec<Seen> {
    let placed = |track: &Track| -> Option<Seen> {
        let is_own = |camera: u16| usize::from(camera) == place;
        let own = track.observations.iter().find(|seen| is_own(seen.camera))?;
        let others = track.observations.iter().filter(|seen| !is_own(seen.camera)).copied();
        let mut of_others = Track { observations: others.collect(), ..*track };
        let is_placed = of_others.observations.len() > 1 && of_others.triangulate(models, 1e3);
        is_placed.then(|| Seen { point: of_others.point, pixel: own.pixel, sigma: own.sigma.max(SIGMA) })
    };
    tracks.iter().filter(|track| track.source == Source::Texture).filter_map(placed).collect()
}

/// The camera with some parameters fitted to what it sees, and the median distance in pixels that is left. The distance is
/// infinite if nothing is left to measure it by.
fn fitted(given: &Model, free: &[usize], seen: &[Seen]) -> (Model, f64) {
    let mut model = *given;
    for scale in SCALES {
        let Some(step) = step(&model, free, seen, scale) else { break };
        model = free.iter().zip(step.iter()).fold(model, |model, (&k, &by)| changed(&model, k, by));
    }
    let left = |seen: &Seen| -> Option<f64> { Some((model.project(seen.point)? - seen.pixel).length()) };
    let mut left: Vec<f64> = seen.iter().filter_map(left).collect();
    (model, median(&mut left).unwrap_or(f64::INFINITY))
}

/// How far apart two cameras see the points, as the root of the mean square, in pixels.
fn apart(a: &Model, b: &Model, seen: &[Seen]) -> f64 {
    let squared =
        |seen: &Seen| -> Option<f64> { Some((a.project(seen.point)? - b.project(seen.point)?).length_squared()) };
    let squares: Vec<f64> = seen.iter().filter_map(squared).collect();
    libm::sqrt(squares.iter().sum::<f64>() / squares.len().max(1) as f64)
}

/// One step of Gauss and Newton. `None` if the points do not determine it.
fn step(model: &Model, free: &[usize], seen: &[Seen], scale: f64) -> Option<DVector<f64>> {
    let count = free.len();
    let (mut matrix, mut right) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
    let varied: Vec<Model> = free.iter().map(|&k| changed(model, k, STEP)).collect();
    let mut slopes: Vec<DVec2> = Vec::with_capacity(count);
    for &Seen { point, pixel, sigma } in seen {
        let Some(at) = model.project(point) else { continue };
        slopes.clear();
        slopes.extend(varied.iter().map(|varied| (varied.project(point).unwrap_or(at) - at) / STEP));
        let w = weight(pixel - at, sigma, scale);
        for (row, a) in slopes.iter().enumerate() {
            right[row] += w * a.dot(pixel - at);
            for (column, b) in slopes[..=row].iter().enumerate() {
                // The lower triangle, which the factorisation reads.
                matrix[(row, column)] += w * a.dot(*b);
            }
        }
    }
    let step: DVector<f64> = Cholesky::new(matrix)?.solve(&right);
    step.iter().all(|by| by.is_finite()).then_some(step)
}

/// The camera with one parameter changed.
fn changed(model: &Model, parameter: usize, by: f64) -> Model {
    if parameter == DISTORTION {
        return model.distorted(by);
    }
    let mut step = [0.0; PARAMETERS];
    step[parameter] = by;
    model.moved(&step)
}

/// Standard deviation of the focal lengths where they are sought, as a share of them.
const FOCAL_SHARE: f64 = 0.03;
/// Focal lengths have an error in common if its median is at least this share of them,
const COMMON: f64 = 0.005;
/// and this many times the standard deviation of the single errors about it.
const COMMON_SPREADS: f64 = 5.0;

/// The cameras with focal lengths that are adjusted, too, and the factor by which all the given ones are too long. `None` if
/// they have no error in common. `scales` are those of the loss.
pub(super) fn common_focal_length(
    given: &[Model],
    tracks: &[Track],
    priors: &Priors,
    scales: &[f64],
) -> Option<(Vec<Model>, f64)> {
    let (mut models, mut tracks, mut priors) = (given.to_vec(), tracks.to_vec(), priors.clone());
    for information in &mut priors.information {
        information[FOCAL][FOCAL] = 1.0 / (FOCAL_SHARE * FOCAL_SHARE);
    }
    adjust(&mut models, &mut tracks, &priors, scales);
    let zooms: Vec<f64> = models.iter().zip(given).map(|(model, given)| -model.deviation(given)[FOCAL]).collect();
    let common = median(&mut zooms.clone())?;
    let spread = robust_sigma(&zooms.iter().map(|zoom| zoom - common).collect::<Vec<f64>>())?;
    (common.abs() > COMMON.max(COMMON_SPREADS * spread)).then(|| (models, libm::exp(common)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        calibration::track::Observation,
        testing::{camera, ring},
    };
    use alloc::vec;
    use glam::Vec3;
    use studio::noise::Random;

    /// A ring of eight cameras.
    fn cameras() -> Vec<Model> {
        ring(8, 3.0, 1.2).map(|from| Model::new(&camera(from, Vec3::ZERO, 640, 800.0), DVec3::ZERO)).collect()
    }

    /// Points in a ball of half a unit, as all cameras see them, about a tenth of a pixel beside where they are.
    fn tracks(truth: &[Model]) -> Vec<Track> {
        let mut random = Random::new(1, 0);
        let mut random = || random.signed();
        let track = |_| {
            let point = DVec3::new(random(), random(), random()) * 0.5;
            let mut seen_by = |camera: usize| Observation {
                camera: camera as u16,
                pixel: truth[camera].project(point).unwrap() + DVec2::new(random(), random()) * 0.15,
                sigma: 0.1,
            };
            let observations = (0..truth.len()).map(&mut seen_by).collect();
            Track { observations, point, source: Source::Texture, held_out: false }
        };
        (0..300).map(track).collect()
    }

    /// The cause of the difference between a given camera and the true one.
    fn found(given: impl Fn(&Model) -> Model) -> Cause {
        let truth = cameras();
        cause(&given(&truth[2]), 2, &truth, &tracks(&truth))
    }

    #[test]
    fn a_wrong_focal_length_is_told_from_a_camera_that_moved() {
        for by in [-0.03, 0.03] {
            let Cause::FocalLength(factor) = found(|model| changed(model, FOCAL, by)) else { panic!("{by}") };
            assert!((factor - libm::exp(by)).abs() < 1e-3, "{by}: {factor}");
        }
    }

    #[test]
    fn a_camera_that_moved_has_the_right_focal_length() {
        // It turned, rolled, and went nearer by three percent of its distance.
        for (parameter, by) in [(0, 0.01), (2, 0.03), (5, 0.1)] {
            assert_eq!(found(|model| changed(model, parameter, by)), Cause::Pose, "{parameter}");
        }
    }

    #[test]
    fn a_wrong_distortion_is_told_from_a_camera_that_moved() {
        let Cause::Distortion(pixels) = found(|model| model.distorted(0.2)) else { panic!("nothing else") };
        // It grows with the third power of the distance from the middle, at most 140 pixels of 800.
        assert!((0.1..0.2 * 140.0 * 0.175 * 0.175).contains(&pixels), "{pixels}");
    }

    #[test]
    fn what_the_matches_do_not_tell_stays_unknown() {
        // Too small for the noise of the matches, two errors at once, and too few matches.
        assert_eq!(found(|model| changed(model, FOCAL, 1e-4)), Cause::Unknown);
        assert_eq!(found(|model| changed(&changed(model, FOCAL, 0.03), 0, 0.01)), Cause::Unknown);
        let truth = cameras();
        let few = &tracks(&truth)[..FEWEST - 1];
        assert_eq!(cause(&changed(&truth[2], 0, 0.01), 2, &truth, few), Cause::Unknown);
    }

    #[test]
    fn an_error_of_all_focal_lengths_is_found() {
        let truth = cameras();
        let priors = |given: &[Model]| {
            let mut information = vec![[[0.0; PARAMETERS]; PARAMETERS]; given.len()];
            // Turns of a pixel, shifts of a footprint.
            let sigmas = [1.0 / 800.0, 3.0 / 800.0_f64];
            information
                .iter_mut()
                .for_each(|of| (0..FOCAL).for_each(|k| of[k][k] = 1.0 / (sigmas[k / 3] * sigmas[k / 3])));
            Priors { given: given.to_vec(), information }
        };
        let scales = [12.0, 5.0, 3.0];
        let given: Vec<Model> = truth.iter().map(|model| changed(model, FOCAL, 0.03)).collect();
        let (_, factor) =
            common_focal_length(&given, &tracks(&truth), &priors(&given), &scales).expect("one in common");
        assert!((factor - libm::exp(0.03)).abs() < 2e-3, "{factor}");
        // Right ones, and a wrong one of a single camera.
        let mut given = truth.clone();
        assert!(common_focal_length(&given, &tracks(&truth), &priors(&given), &scales).is_none());
        given[2] = changed(&given[2], FOCAL, 0.03);
        assert!(common_focal_length(&given, &tracks(&truth), &priors(&given), &scales).is_none());
    }
}
