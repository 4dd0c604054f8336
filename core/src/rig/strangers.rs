//! Cameras whose positions are in another unit than those of the others. A few of them drag the point where all cameras look so
//! far away that no distance from it looks wrong.

use super::{
    limits::Readable,
    meeting::{MIN_VIEWS, meeting_point},
};
use crate::{
    camera::Camera,
    error::{Error, Result},
    sort::short_by,
};
use alloc::{format, vec::Vec};
use glam::DVec3;

/// Cameras that look at one object from several sides have a mean direction shorter than this. The axes of others may meet at
/// themselves, where they stand close together.
const NARROW: f64 = 0.9;
/// A camera in another unit is this many times farther away than the others are. Inches in place of metres are 39 times.
const STRANGE: f64 = 20.0;

/// Refuses a camera that is much farther from where the others look than they are. The others are those near the middle of all,
/// at least a quarter; if they do not look at one place, nothing is known.
///
/// # Errors
/// [`Error::Camera`].
pub(super) fn check(cameras: &[Camera]) -> Result<()> {
    let centres: Vec<DVec3> = cameras.iter().map(Camera::centre).collect();
    let middle = DVec3::from_array([0, 1, 2].map(|axis| {
        let mut along: Vec<f64> = centres.iter().map(|centre| centre[axis]).collect();
        short_by(&mut along, f64::total_cmp);
        along[(along.len() - 1) / 2]
    }));
    let reach: Vec<f64> = centres.iter().map(|centre| (*centre - middle).length()).collect();
    let mut sorted = reach.clone();
    short_by(&mut sorted, f64::total_cmp);
    let near = STRANGE * sorted[sorted.len() / 4];
    let rest: Vec<Camera> = cameras.iter().zip(&reach).filter(|(_, reach)| **reach <= near).map(|(c, _)| *c).collect();
    if rest.len() == cameras.len() || rest.len() < MIN_VIEWS as usize {
        return Ok(());
    }
    let meeting = meeting_point(rest.iter());
    let mean = rest.iter().map(Camera::direction).sum::<DVec3>() / rest.len() as f64;
    let in_front = |camera: &Camera| (meeting - camera.centre()).dot(camera.direction()) > 0.0;
    if mean.length() > NARROW || !rest.iter().all(in_front) {
        return Ok(());
    }
    let distance = rest.iter().map(|camera| (camera.centre() - meeting).length()).sum::<f64>() / rest.len() as f64;
    let far = centres.iter().position(|centre| (*centre - meeting).length() > STRANGE * distance);
    far.map_or(Ok(()), |place| {
        let problem = format!(
            "it is {} units from where {} other cameras look, which are {} units away on average: check its t, and that all \
             cameras have the same unit",
            Readable((centres[place] - meeting).length()),
            rest.len(),
            Readable(distance)
        );
        Err(Error::Camera { camera: place as u32, problem })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{camera, ring};
    use glam::Vec3;

    fn dome(count: u32) -> Vec<Camera> {
        ring(count, 3.0, 1.2).map(|from| camera(from, Vec3::new(0.2, 0.1, 0.3), 64, 60.0)).collect()
    }

    #[test]
    fn cameras_in_another_unit_are_named() {
        for (count, others) in [(20, &[5][..]), (20, &[0, 3, 4, 8, 12]), (7, &[2]), (10, &[1, 3, 5, 7, 9])] {
            let mut cameras = dome(count);
            assert_eq!(check(&cameras), Ok(()));
            for &place in others {
                cameras[place].t = cameras[place].t.map(|v| if others.len() == 1 { 39.37 * v } else { 1000.0 * v });
            }
            assert_eq!(check(&cameras).unwrap_err().camera(), Some(others[0] as u32), "{count} {others:?}");
        }
    }

    #[test]
    fn cameras_that_are_only_unevenly_spread_are_not() {
        // Most stand within a centimetre, and look at what all others see.
        let mut cameras = dome(9);
        for (i, crowded) in cameras.iter_mut().enumerate().skip(4) {
            *crowded = camera(Vec3::new(3.0, 0.001 * i as f32, 1.2), Vec3::ZERO, 64, 60.0);
        }
        assert_eq!(check(&cameras), Ok(()));
        // In parallel they do not tell where they look.
        for (i, crowded) in cameras.iter_mut().enumerate().skip(4) {
            let from = Vec3::new(3.0, 0.001 * i as f32, 1.2);
            *crowded = camera(from, from + Vec3::new(-3.0, 0.0, 0.0), 64, 60.0);
        }
        assert_eq!(check(&cameras), Ok(()));
    }
}
