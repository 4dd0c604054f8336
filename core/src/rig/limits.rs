//! What a calibration can be in reason. Numbers beyond it are mistakes: of units, of the order of numbers, of digits. They are
//! refused before anything is allocated, because single precision and grids of bounded size have no room for them.

use crate::{
    camera::Camera,
    error::{Error, Result},
    sort::short_by,
};
use alloc::{format, string::String, vec::Vec};
use core::fmt;
use glam::{DVec2, DVec3};

/// Longest side of a picture, in pixels. Source positions in the map of a lens are fixed-point numbers of 32 bits, which
/// overflow beyond it.
const LONGEST_SIDE: u32 = 1 << 15;
/// Most pixels of one picture, and of all pictures of a rig.
const MOST_PIXELS: u64 = 1 << 28;
const MOST_PIXELS_OF_RIG: u64 = 1 << 34;
/// Smallest and largest focal length, as a share of the picture's longer side: angles of view of 179° and of 0.06°.
const FOCAL: [f64; 2] = [0.01, 1000.0];
/// Largest ratio of the two focal lengths.
const ASPECT: f64 = 10.0;
/// Largest distance of the principal point from the picture's middle, as a share of the longer side. Pictures that are cut out
/// of larger ones have it outside.
const PRINCIPAL_POINT: f64 = 10.0;
/// Smallest share of the undistorted picture that shows something.
const SHOWN: f64 = 0.05;
/// Places along each side of a picture at which the lens is tried.
const PLACES: u32 = 17;
/// Largest coordinate of a camera's position, in scene units.
const FARTHEST: f64 = 1e15;
/// Smallest and largest distance of a camera from where the cameras look, in scene units. The fourth power of a footprint
/// there still is a number in single precision.
const DISTANCE: [f64; 2] = [1e-6, 1e9];
/// A camera is not this many times nearer or farther than the median camera.
pub(super) const DISPROPORTION: f64 = 100.0;
/// Largest distance of the scene from its zero, in distances of the cameras from where they look. Up to there, double precision
/// moves a projection by less than a ten-thousandth of a pixel.
const OFFSET: f64 = 1e8;

/// Refuses a camera whose own numbers are out of reason. They are finite.
///
/// # Errors
/// What is wrong and what to do.
pub(super) fn check(camera: &Camera) -> core::result::Result<(), String> {
    let (w, h) = (camera.width, camera.height);
    if w > LONGEST_SIDE || h > LONGEST_SIDE || u64::from(w) * u64::from(h) > MOST_PIXELS {
        return Err(format!(
            "the calibrated size is {w} x {h} pixels: sides can have up to {LONGEST_SIDE} pixels and pictures up to \
             {MOST_PIXELS}; check width and height, or scale pictures and K"
        ));
    }
    let side = f64::from(w.max(h));
    let [fx, fy] = [camera.k[0][0], camera.k[1][1]];
    if fx.min(fy) < FOCAL[0] * side || fx.max(fy) > FOCAL[1] * side || fx.max(fy) > ASPECT * fx.min(fy) {
        return Err(format!(
            "the focal lengths {fx:e} and {fy:e} do not belong to pictures of {w} x {h} pixels: give them in pixels of the \
             calibrated size"
        ));
    }
    let beside = DVec2::new(camera.k[0][2], camera.k[1][2]) - DVec2::new(f64::from(w), f64::from(h)) * 0.5;
    if beside.abs().max_element() > PRINCIPAL_POINT * side || camera.k[0][1].abs() > fx {
        return Err(format!(
            "the principal point ({:e}, {:e}) or the skew {:e} does not belong to pictures of {w} x {h} pixels: give K in pixels \
             of the calibrated size",
            camera.k[0][2], camera.k[1][2], camera.k[0][1]
        ));
    }
    if camera.lens.is_distorted() && shown(camera) < SHOWN {
        return Err(format!(
            "with the distortion {:?} the undistorted picture shows nearly nothing: check the order of the coefficients \
             (k1, k2, p1, p2, k3 and so on), or calibrate again",
            camera.lens.coefficients()
        ));
    }
    let t = DVec3::from_array(camera.t);
    if t.abs().max_element() > FARTHEST {
        return Err(format!(
            "t is ({:e}, {:e}, {:e}): coordinates go up to {FARTHEST:e}; check the units",
            t.x, t.y, t.z
        ));
    }
    Ok(())
}

/// Share of the undistorted picture whose pixels the lens takes from within the real one.
fn shown(camera: &Camera) -> f64 {
    let last = DVec2::new(f64::from(camera.width - 1), f64::from(camera.height - 1));
    let places = (0..PLACES * PLACES).map(|i| DVec2::new(f64::from(i % PLACES), f64::from(i / PLACES)));
    let sources = places.map(|place| camera.distort_pixel(last * place / f64::from(PLACES - 1)));
    let within = |source: &DVec2| source.min_element() >= -0.5 && (last - *source).min_element() >= -0.5;
    sources.filter(within).count() as f64 / f64::from(PLACES * PLACES)
}

/// Refuses a rig whose pictures together are out of reason.
///
/// # Errors
/// [`Error::Cameras`].
pub(super) fn check_pictures(cameras: &[Camera]) -> Result<()> {
    let pixels = cameras.iter().map(|c| u64::from(c.width) * u64::from(c.height)).sum::<u64>();
    if pixels > MOST_PIXELS_OF_RIG {
        let problem = format!(
            "the pictures of all cameras have {pixels} pixels together, and a rig can have {MOST_PIXELS_OF_RIG}: scale pictures \
             and K, or leave out cameras"
        );
        return Err(Error::Cameras { problem });
    }
    Ok(())
}

/// A number as people write it: up to four digits, and a power of ten only where it is very large or small.
pub(super) struct Readable(pub(super) f64);

impl fmt::Display for Readable {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let size = self.0.abs();
        match size {
            0.0 => f.write_str("0"),
            1e3..1e6 => write!(f, "{:.0}", self.0),
            1e2..1e3 => write!(f, "{:.1}", self.0),
            1e1..1e2 => write!(f, "{:.2}", self.0),
            1e-2..1e1 => write!(f, "{:.3}", self.0),
            _ => write!(f, "{:.3e}", self.0),
        }
    }
}

/// Refuses cameras whose distances from `meeting`, where they look, are out of reason.
///
/// # Errors
/// [`Error::Camera`] for one that is much nearer or farther than the others, and [`Error::Cameras`].
pub(super) fn check_distances(cameras: &[Camera], meeting: DVec3) -> Result<()> {
    let distances: Vec<f64> = cameras.iter().map(|camera| (camera.centre() - meeting).length()).collect();
    let mut sorted = distances.clone();
    short_by(&mut sorted, f64::total_cmp);
    let median = sorted[sorted.len() / 2];
    if !(DISTANCE[0]..=DISTANCE[1]).contains(&median) {
        let problem = format!(
            "the cameras are {} units from where they look, and can be {} to {}: give R, t and the scene in metres, or in \
             another unit of that kind",
            Readable(median),
            Readable(DISTANCE[0]),
            Readable(DISTANCE[1])
        );
        return Err(Error::Cameras { problem });
    }
    let out = |distance: f64| distance > DISPROPORTION * median || distance * DISPROPORTION < median;
    if let Some(camera) = distances.iter().position(|&distance| out(distance)) {
        let problem = format!(
            "it is {} units from where the cameras look, but the median of the cameras is {} units away: check its t, and \
             that all cameras have the same unit",
            Readable(distances[camera]),
            Readable(median)
        );
        return Err(Error::Camera { camera: camera as u32, problem });
    }
    if meeting.length() > OFFSET * median {
        let problem = format!(
            "the cameras are {} units from where they look, and that is {} units from the scene's zero, where numbers are too \
             coarse: subtract a common offset from the positions",
            Readable(median),
            Readable(meeting.length())
        );
        return Err(Error::Cameras { problem });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lens::Lens,
        testing::{camera, ring},
    };
    use glam::Vec3;

    fn dome() -> Vec<Camera> {
        ring(7, 3.0, 1.2).map(|from| camera(from, Vec3::ZERO, 64, 60.0)).collect()
    }

    #[test]
    fn numbers_are_written_as_people_write_them() {
        let written = |v: f64| format!("{}", Readable(v));
        assert_eq!([0.0, 3622.472, 362.247, 36.2247, 3.62247].map(written), ["0", "3622", "362.2", "36.22", "3.622"]);
        assert_eq!([-0.25, 3.62e-5, 1.5e9].map(written), ["-0.250", "3.620e-5", "1.500e9"]);
    }

    #[test]
    fn numbers_out_of_reason_are_refused() {
        let changes: [fn(&mut Camera); 16] = [
            |c| c.width = u32::MAX,
            |c| c.height = 40_000,
            |c| (c.width, c.height) = (30_000, 30_000),
            |c| c.k[0][0] *= 1e4,
            |c| c.k[1][1] *= 1e300,
            |c| (c.k[0][0], c.k[1][1]) = (0.1, 0.1),
            |c| c.k[0][0] *= 30.0,
            |c| c.k[0][2] = 1e6,
            |c| c.k[1][2] = -1e300,
            |c| c.k[0][1] = 1e5,
            |c| c.lens = Lens::brown([1e300, 0.0, 0.0, 0.0, 0.0]),
            |c| c.lens = Lens::brown([1e4, 0.0, 0.0, 0.0, 0.0]),
            |c| c.lens = Lens::brown([0.0, 0.0, 0.0, 0.0, -1e30]),
            |c| c.lens = Lens::brown([0.0, 0.0, 1e3, 0.0, 0.0]),
            |c| c.t[1] = 1e16,
            |c| c.t[2] = -1e300,
        ];
        for (i, change) in changes.iter().enumerate() {
            let mut camera = dome()[2];
            change(&mut camera);
            assert!(check(&camera).is_err(), "change {i}");
        }
    }

    #[test]
    fn unusual_cameras_are_not_refused() {
        let changes: [fn(&mut Camera); 6] = [
            |c| (c.k[0][0], c.k[1][1]) = (20.0, 10.0),
            |c| (c.k[0][0], c.k[1][1]) = (6000.0, 6000.0),
            |c| c.k[0][2] = -300.0,
            |c| c.lens = Lens::brown([0.8, 0.0, 0.0, 0.0, 0.0]),
            |c| c.lens = Lens::brown([-0.6, 0.3, 0.01, 0.01, -0.1]),
            |c| c.t[0] = 1e7,
        ];
        for (i, change) in changes.iter().enumerate() {
            let mut camera = dome()[2];
            change(&mut camera);
            assert_eq!(check(&camera), Ok(()), "change {i}");
        }
    }

    /// The camera whose distance is out of proportion, if there is one; `None` if the rig as a whole is refused.
    fn refused(scale: f64, change: impl Fn(&mut [Camera])) -> Option<Option<u32>> {
        let mut cameras = dome();
        cameras.iter_mut().for_each(|c| c.t = c.t.map(|v| v * scale));
        change(&mut cameras);
        check_distances(&cameras, DVec3::ZERO).err().map(|error| error.camera())
    }

    #[test]
    fn distances_out_of_reason_are_refused() {
        for scale in [1e-30, 1e-7, 1e10, 1e14] {
            assert_eq!(refused(scale, |_| ()), Some(None), "{scale}");
        }
        for scale in [1e-5, 1.0, 1e3, 1e8] {
            assert_eq!(refused(scale, |_| ()), None, "{scale}");
            assert_eq!(refused(scale, |cameras| cameras[3].t = cameras[3].t.map(|v| v * 50.0)), None);
            assert_eq!(refused(scale, |cameras| cameras[3].t = cameras[3].t.map(|v| v * 1e3)), Some(Some(3)));
            assert_eq!(refused(scale, |cameras| cameras[5].t = cameras[5].t.map(|v| v * 1e-3)), Some(Some(5)));
        }
    }

    #[test]
    fn a_scene_too_far_from_its_zero_is_refused() {
        let refused = |meeting: DVec3| {
            let mut cameras = dome();
            for camera in &mut cameras {
                let moved = |row: usize| camera.t[row] - DVec3::from_array(camera.r[row]).dot(meeting);
                camera.t = [0, 1, 2].map(moved);
            }
            check_distances(&cameras, meeting).is_err()
        };
        // Surveyors' coordinates in metres are not.
        assert!(!refused(DVec3::new(448_291.5, 5_411_932.1, 113.0)));
        assert!(refused(DVec3::new(0.0, 1e9, 0.0)));
    }

    #[test]
    fn pictures_of_all_cameras_have_a_bound() {
        let mut cameras = dome();
        cameras.iter_mut().for_each(|c| (c.width, c.height) = (1 << 14, 1 << 14));
        assert_eq!(check_pictures(&cameras), Ok(()));
        let many: Vec<Camera> = cameras.iter().cycle().take(65).copied().collect();
        assert!(check_pictures(&many).is_err());
    }
}
