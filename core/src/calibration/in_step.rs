//! Whether the cameras of a take show the same instants, by their silhouettes.
//!
//! The other cameras' hull of a frame is compared with a camera's silhouettes of that frame and of those before and after
//! it. A camera whose silhouettes fit the hulls better when all are taken some frames later is late by so many frames.
//! A subject that stands still fits in all frames alike and tells nothing.

use crate::{
    error::{Error, Result},
    executor::{Executor, Serial},
    hull::{HullParams, VisualHull, compare},
    progress::{self, Progress},
    rig::Rig,
    stage::Stage,
    surface::drop_small_components,
    view::View,
    workspace::Workspace,
};
use alloc::{vec, vec::Vec};

/// Frames before and after that are tried. The last one is only tried to see that those before it are better.
const REACH: i32 = 4;
/// All shifts that are tried.
const SHIFTS: usize = 2 * REACH as usize + 1;
/// Spacing of the hulls' grids in pixels of footprint. Silhouettes are compared with the same hull, so that its coarseness
/// cancels out.
const VOXEL_PIXELS: f32 = 4.0;
/// Parts of the hull that are smaller than this share of the largest are dropped.
const SMALLEST_PART: f32 = 0.01;
/// A shift is better than another if it brings contours and hulls closer by this many pixels on average,
const CLOSER: f64 = 0.15;
/// and by this many standard deviations of that average.
const CERTAIN: f64 = 2.0;
/// Fewest frames that say which of two shifts is better.
const FRAMES: usize = 2;
/// Shifting one camera changes the hulls with which the others are compared, so that all are compared again.
const ROUNDS: u32 = 3;

/// The distances between a camera's contours and the hull of the others in one frame, in pixels, for every shift. `None`
/// where there is no silhouette.
type Distances = [Option<f32>; SHIFTS];

/// For every camera of a rig, by its index, the number of frames by which its pictures are late: at the instant of frame f it
/// shows frame f + offset. 0 is in step, and `None` means that the frames do not tell. Each frame has its number, and one
/// view per camera in the order of [`Rig::order`], of which only the silhouettes are read. Shifts of up to three
/// frames are found, if the frames have successive numbers: eight of them are enough if the subject moves.
///
/// # Errors
/// [`Error::ViewCount`] and [`Error::Cancelled`].
pub fn out_of_step(
    rig: &Rig,
    frames: &[(u32, Vec<View>)],
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<Option<i32>>> {
    let count = rig.cameras().len();
    if let Some((_, views)) = frames.iter().find(|(_, views)| views.len() != count) {
        return Err(Error::ViewCount { given: views.len() as u32, cameras: count as u32 });
    }
    let mut applied = vec![0; count];
    let mut found = Vec::new();
    for _ in 0..ROUNDS {
        let of_cameras = distances(frames, &applied, executor, progress)?;
        found = of_cameras.iter().map(|of_frames| best(of_frames)).collect();
        let shifts: Vec<i32> = found.iter().map(|shift| shift.unwrap_or(0)).collect();
        if shifts == applied {
            break;
        }
        // What changes in the last round is not certain.
        for (found, (shift, before)) in found.iter_mut().zip(shifts.iter().zip(&applied)) {
            *found = found.filter(|_| shift == before);
        }
        applied = shifts;
    }
    let mut by_index = vec![None; count];
    for (place, shift) in found.into_iter().enumerate() {
        by_index[rig.order()[place] as usize] = shift;
    }
    Ok(by_index)
}

/// The view of the camera at a place in the frame that is some frames later.
fn shifted(frames: &[(u32, Vec<View>)], frame: usize, place: usize, shift: i32) -> Option<&View> {
    let number = frames[frame].0.checked_add_signed(shift)?;
    frames.iter().find(|(other, _)| *other == number).map(|(_, views)| &views[place])
}

/// The distances of every camera, by place, in every frame. The hulls are those of the pictures that are `applied` frames
/// later.
fn distances(
    frames: &[(u32, Vec<View>)],
    applied: &[i32],
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<Vec<Distances>>> {
    let (count, total) = (applied.len(), applied.len() * frames.len());
    let of = |workspace: &mut Workspace, i: usize| {
        progress::step(progress, Stage::Hull, i as u32, total as u32)?;
        let (place, frame) = (i / frames.len(), i % frames.len());
        let silhouette =
            |place: usize, shift: i32| shifted(frames, frame, place, shift)?.silhouette_as_given().cloned();
        let camera = |place: usize| frames[frame].1[place].camera;
        let others: Vec<View> = (0..count)
            .map(|other| (other, silhouette(other, applied[other]).filter(|_| other != place)))
            .map(|(other, silhouette)| View::of_silhouette(other as u16, camera(other), silhouette))
            .collect();
        let own: Vec<View> = (-REACH..=REACH)
            .map(|shift| View::of_silhouette(place as u16, camera(place), silhouette(place, shift)))
            .collect();
        let params = HullParams { voxel_pixels: VOXEL_PIXELS };
        let hull = match VisualHull::with_workspace(&others, &params, None, workspace, &Serial, progress) {
            Ok(hull) => hull,
            Err(Error::Cancelled) => return Err(Error::Cancelled),
            // Nothing can be said about this frame.
            Err(_) => return Ok([None; SHIFTS]),
        };
        let mut mesh = hull.mesh(workspace, &Serial);
        drop_small_components(&mut mesh, SMALLEST_PART, workspace);
        let compared = compare(&own, &mesh, &Serial, progress)?;
        hull.recycle_into(workspace);
        mesh.recycle_into(workspace);
        Ok(core::array::from_fn(|shift| compared[shift].apart))
    };
    let all: Vec<Distances> = executor.map_with(&mut Vec::new(), total, of).into_iter().collect::<Result<_>>()?;
    Ok(all.chunks(frames.len().max(1)).map(<[Distances]>::to_vec).collect())
}

/// The shift with which a camera fits better than with any other that was tried, if the ones before and after it are among
/// those.
fn best(of_frames: &[Distances]) -> Option<i32> {
    let tried = |a: usize, b: usize| a < SHIFTS && b < SHIFTS && closer(of_frames, a, b).is_some();
    let is_best = |a: usize| {
        a > 0
            && tried(a, a - 1)
            && tried(a, a + 1)
            && (0..SHIFTS).filter(|&b| b != a).all(|b| closer(of_frames, a, b).unwrap_or(true))
    };
    (0..SHIFTS).find(|&a| is_best(a)).map(|a| a as i32 - REACH)
}

/// Whether a shift is better than another. `None` if there are too few frames to tell.
fn closer(of_frames: &[Distances], a: usize, b: usize) -> Option<bool> {
    let gains: Vec<f64> =
        of_frames.iter().filter_map(|shifts| Some(f64::from(shifts[b]?) - f64::from(shifts[a]?))).collect();
    if gains.len() < FRAMES {
        return None;
    }
    let n = gains.len() as f64;
    let mean = gains.iter().sum::<f64>() / n;
    let variance = gains.iter().map(|gain| (gain - mean) * (gain - mean)).sum::<f64>() / (n * (n - 1.0));
    Some(mean > CLOSER && mean > CERTAIN * libm::sqrt(variance))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances that grow with the time between a frame and the picture, plus what the hull's coarseness adds.
    fn distances(frames: usize, late: i32, speed: f32) -> Vec<Distances> {
        let of = |frame: i32| {
            core::array::from_fn(|i| {
                let shift = i as i32 - REACH;
                let exists = (0..frames as i32).contains(&(frame + shift));
                exists.then(|| 0.5 + 0.1 * (frame % 3) as f32 + speed * (shift - late).abs() as f32)
            })
        };
        (0..frames as i32).map(of).collect()
    }

    #[test]
    fn a_camera_is_late_by_the_frames_after_which_it_fits_best() {
        for late in -3..=3 {
            assert_eq!(best(&distances(8, late, 1.0)), Some(late));
        }
        assert_eq!(best(&distances(8, 4, 1.0)), None, "what comes after it is not known");
    }

    #[test]
    fn frames_without_motion_or_too_few_tell_nothing() {
        assert_eq!(best(&distances(8, 0, 0.0)), None);
        assert_eq!(best(&distances(8, 2, 0.1)), None);
        assert_eq!(best(&distances(2, 0, 1.0)), None);
        assert_eq!(best(&distances(3, 0, 1.0)), Some(0));
        assert_eq!(best(&distances(3, 1, 1.0)), None);
        assert_eq!(best(&[]), None);
    }

    #[test]
    fn what_only_one_of_many_frames_says_is_not_certain() {
        let mut of_frames = distances(8, 0, 0.0);
        of_frames[3][REACH as usize + 1] = of_frames[3][REACH as usize + 1].map(|d| d + 9.0);
        assert_eq!(best(&of_frames), None);
    }
}
