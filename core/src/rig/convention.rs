//! Recognises poses that are given in another convention than that of [`Camera`].
//!
//! The cameras of a capture look at one object, so that their optical axes nearly meet at one point in front of all of
//! them. If they do not as they are given, but do when the poses are read in another common convention, the poses are
//! given in that one.

use super::meeting::{MIN_VIEWS, meeting_point};
use crate::{
    camera::Camera,
    error::{Error, Result},
};
use alloc::{format, vec::Vec};
use glam::{DMat3, DVec3};

/// Axes are parallel if the length of their mean direction exceeds this: they differ from it by less than 1.8° (root mean
/// square).
const PARALLEL: f64 = 0.9995;
/// Cameras stand at one place if they are closer together than this share of the distance to where their axes meet.
const ONE_PLACE: f64 = 1e-4;
/// Axes meet if they pass their common point at less than this share of its distance (root mean square). The axes of
/// cameras that look at different parts of an object pass at up to a fifth.
const MEETING: f64 = 0.25;

/// Mirrors a camera's or the world's first axis.
const MIRROR: DMat3 = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
/// Turns a camera around its axis.
const AROUND: DMat3 = DMat3::from_diagonal(DVec3::new(-1.0, -1.0, 1.0));

/// How R and t of a file may be meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Pose {
    /// World to camera.
    WorldToCamera,
    /// Camera to world: t is the camera's centre, and the columns of R are its axes.
    CameraToWorld,
    /// R is world to camera, but t is the camera's centre.
    Centre,
    /// The columns of R are the camera's axes, but t is world to camera.
    Transposed,
    /// World to camera, but only R has the camera's axes turned, and t has not.
    RotationTurned,
    /// World to camera in a left-handed world: the first row of R and of t and the first column of R have the other sign.
    LeftHanded,
    /// World to camera, but the pictures are mirrored. The camera that takes such pictures stands in a mirrored world.
    Mirrored,
    /// World to camera, but the pictures are turned by 180°.
    TurnedAround,
}

/// How the axes of a camera may be meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Turn {
    /// x right, y down, z forward.
    None,
    /// Those of OpenGL: x right, y up, z backward.
    OpenGl,
    /// Those of PyTorch3D: x left, y up, z forward.
    UpsideDown,
}

impl Turn {
    fn signs(self) -> DVec3 {
        match self {
            Self::None => DVec3::ONE,
            Self::OpenGl => DVec3::new(1.0, -1.0, -1.0),
            Self::UpsideDown => DVec3::new(-1.0, -1.0, 1.0),
        }
    }
}

/// A convention for poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Convention {
    pose: Pose,
    turn: Turn,
}

impl Convention {
    /// All conventions except that of [`Camera`], the most common ones first.
    pub const OTHERS: [Self; 12] = [
        Self::new(Pose::WorldToCamera, Turn::OpenGl),
        Self::new(Pose::CameraToWorld, Turn::None),
        Self::new(Pose::CameraToWorld, Turn::OpenGl),
        Self::new(Pose::Centre, Turn::None),
        Self::new(Pose::Centre, Turn::OpenGl),
        Self::new(Pose::Transposed, Turn::None),
        Self::new(Pose::Transposed, Turn::OpenGl),
        Self::new(Pose::WorldToCamera, Turn::UpsideDown),
        Self::new(Pose::RotationTurned, Turn::OpenGl),
        Self::new(Pose::LeftHanded, Turn::None),
        Self::new(Pose::Mirrored, Turn::None),
        Self::new(Pose::TurnedAround, Turn::None),
    ];

    const fn new(pose: Pose, turn: Turn) -> Self {
        Self { pose, turn }
    }

    /// A camera whose pose is given in this convention, in that of [`Camera`].
    #[inline(never)]
    pub fn read(self, camera: &Camera) -> Camera {
        // The rows of the array are the columns of the matrix.
        let transposed = DMat3::from_cols_array_2d(&camera.r);
        let (given, t) = (transposed.transpose(), DVec3::from_array(camera.t));
        // The axes are those of the camera: of the rows of world to camera, of the columns of camera to world.
        let turn = DMat3::from_diagonal(self.turn.signs());
        let (r, t) = match self.pose {
            Pose::WorldToCamera => (turn * given, turn * t),
            Pose::CameraToWorld => (turn * transposed, -(turn * transposed * t)),
            Pose::Centre => (turn * given, -(turn * given * t)),
            Pose::Transposed => (turn * transposed, turn * t),
            Pose::RotationTurned => (turn * given, t),
            Pose::LeftHanded | Pose::Mirrored => (MIRROR * given * MIRROR, MIRROR * t),
            Pose::TurnedAround => (AROUND * given, AROUND * t),
        };
        let mut k = camera.k;
        if matches!(self.pose, Pose::Mirrored | Pose::TurnedAround) {
            k[0][2] = f64::from(camera.width) - 1.0 - k[0][2];
        }
        if self.pose == Pose::TurnedAround {
            k[1][2] = f64::from(camera.height) - 1.0 - k[1][2];
        }
        Camera { k, r: r.transpose().to_cols_array_2d(), t: t.to_array(), ..*camera }
    }

    /// What to do about poses in this convention.
    pub fn remedy(self) -> &'static str {
        let opengl = self.turn == Turn::OpenGl;
        match (self.pose, opengl) {
            // The axes are not those of `Camera`.
            (Pose::WorldToCamera, false) => {
                "the axes look like x left, y up, z forward (PyTorch3D): negate the first and second row of R and of t"
            }
            (Pose::WorldToCamera, true) => {
                "the axes look like OpenGL (y up, z backward): negate the second and third row of R and of t. If \
                 they are not, t has the wrong sign: negate t alone"
            }
            (Pose::CameraToWorld, false) => {
                "R, t look like camera to world: give their inverse, world to camera (R transposed, and -R transposed t)"
            }
            (Pose::CameraToWorld, true) => {
                "R, t look like camera to world with OpenGL's axes (y up, z backward): negate the second and third column \
                 of R, then give the inverse (R transposed, and -R transposed t)"
            }
            (Pose::Centre, false) => "t looks like the camera's centre: give t = -R centre",
            (Pose::Centre, true) => {
                "t looks like the camera's centre, and the axes like OpenGL (y up, z backward): negate the second and third \
                 row of R, then give t = -R centre"
            }
            (Pose::Transposed, false) => "R looks like camera to world, but t does not: transpose R",
            (Pose::Transposed, true) => {
                "R looks like camera to world with OpenGL's axes (y up, z backward), but t does not: transpose R, then negate \
                 the second and third row of R and of t"
            }
            (Pose::RotationTurned, _) => {
                "R looks like that of OpenGL's axes (y up, z backward), but t does not: negate the second and third row of R"
            }
            (Pose::LeftHanded, _) => {
                "the world looks left-handed: negate the first row of R and of t, and then the first column of R"
            }
            (Pose::Mirrored, _) => "the pictures look mirrored: mirror pictures and masks",
            (Pose::TurnedAround, _) => "the pictures look turned by 180°: turn pictures and masks",
        }
    }

    /// The cameras read in this convention, if their axes meet.
    pub fn meeting(self, cameras: &[Camera]) -> Option<(f64, Vec<Camera>)> {
        let read: Vec<Camera> = cameras.iter().map(|camera| self.read(camera)).collect();
        let miss = Axes::new(&read, meeting_point(read.iter())).miss()?;
        Some((miss, read))
    }
}

/// How the optical axes of cameras lie.
struct Axes {
    cameras: usize,
    /// Cameras in front of which the axes meet.
    in_front: usize,
    /// Length of the mean direction.
    agreement: f64,
    /// Largest distance of two cameras, and mean distance to the meeting point.
    extent: f64,
    distance: f64,
    /// Root mean square distance of the axes from the meeting point.
    miss: f64,
}

impl Axes {
    fn new(cameras: &[Camera], meeting: DVec3) -> Self {
        let n = cameras.len() as f64;
        let depth = |c: &Camera| (meeting - c.centre()).dot(c.direction());
        let from = |c: &Camera| (meeting - c.centre()).length();
        let miss = |c: &Camera| (meeting - c.centre() - c.direction() * depth(c)).length_squared();
        let sum = cameras.iter().map(Camera::direction).sum::<DVec3>();
        let extent = cameras.iter().map(|c| (c.centre() - cameras[0].centre()).length()).fold(0.0, f64::max);
        Self {
            cameras: cameras.len(),
            in_front: cameras.iter().filter(|c| depth(c) > 0.0).count(),
            agreement: sum.length() / n,
            extent,
            distance: cameras.iter().map(from).sum::<f64>() / n,
            miss: libm::sqrt(cameras.iter().map(miss).sum::<f64>() / n),
        }
    }

    fn are_parallel(&self) -> bool {
        self.agreement > PARALLEL
    }

    fn are_at_one_place(&self) -> bool {
        self.extent <= ONE_PLACE * self.distance || self.extent == 0.0
    }

    /// By which share of its distance the axes miss their common point, if they meet in front of all cameras.
    fn miss(&self) -> Option<f64> {
        let sound = self.in_front == self.cameras && !self.are_parallel() && !self.are_at_one_place();
        let miss = self.miss / self.distance;
        (sound && miss < MEETING).then_some(miss)
    }
}

/// Refuses cameras that cannot see one object. `meeting` is the point nearest to all optical axes. A remedy is named if
/// the axes meet when the poses are read in another convention.
///
/// # Errors
/// [`Error::Cameras`].
pub(super) fn check(cameras: &[Camera], meeting: DVec3) -> Result<()> {
    let axes = Axes::new(cameras, meeting);
    let (what, remedy) = if axes.are_at_one_place() {
        ("the cameras all stand at one place", "cameras must stand around the object")
    } else if axes.are_parallel() {
        (
            "the cameras' axes are parallel to within 2°, so that where they look does not tell where the object is",
            "turn the cameras towards the object, or leave out those that look past it",
        )
    } else if axes.in_front < (MIN_VIEWS as usize).max(axes.cameras.div_ceil(4)) {
        (
            "the cameras look away from each other and from the object",
            "R, t must be world to camera, with x right, y down and z forward",
        )
    } else {
        return Ok(());
    };
    let likely = Convention::OTHERS.into_iter().filter_map(|other| Some((other.meeting(cameras)?.0, other)));
    // Of equally good ones the first is the most common.
    let likely = likely.reduce(|best, next| if next.0 < best.0 - 1e-9 { next } else { best });
    let remedy = likely.map_or(remedy, |(_, convention)| convention.remedy());
    Err(Error::Cameras { problem: format!("{what}: {remedy}") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{camera, ring};
    use glam::Vec3;

    /// A pose in a convention, from that of [`Camera`].
    fn write(convention: Convention, camera: &Camera) -> Camera {
        let r = DMat3::from_cols_array_2d(&camera.r).transpose();
        let turn = DMat3::from_diagonal(convention.turn.signs());
        let (own, t, centre) = (turn * r, turn * DVec3::from_array(camera.t), camera.centre());
        let (r, t) = match convention.pose {
            Pose::WorldToCamera => (own, t),
            Pose::CameraToWorld => (own.transpose(), centre),
            Pose::Centre => (own, centre),
            Pose::Transposed => (own.transpose(), t),
            Pose::RotationTurned => (own, DVec3::from_array(camera.t)),
            // They undo themselves.
            Pose::LeftHanded | Pose::Mirrored | Pose::TurnedAround => return convention.read(camera),
        };
        Camera { r: r.transpose().to_cols_array_2d(), t: t.to_array(), ..*camera }
    }

    fn dome(at: Vec3) -> Vec<Camera> {
        ring(7, 3.0, 1.2).map(|from| camera(from + at, at, 64, 60.0)).collect()
    }

    #[test]
    fn poses_of_every_convention_are_read_back() {
        for convention in Convention::OTHERS {
            for camera in dome(Vec3::new(0.3, -0.2, 1.0)) {
                let read = convention.read(&write(convention, &camera));
                let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
                assert!(close(read.r.as_flattened(), camera.r.as_flattened()) && close(&read.t, &camera.t));
            }
        }
    }

    #[test]
    fn a_ring_whose_axes_are_those_of_opengl_looks_away() {
        let opengl = Convention { pose: Pose::WorldToCamera, turn: Turn::OpenGl };
        let cameras: Vec<Camera> = dome(Vec3::ZERO).iter().map(|c| write(opengl, c)).collect();
        let error = check(&cameras, meeting_point(cameras.iter())).unwrap_err();
        let Error::Cameras { problem } = &error else { panic!("{error}") };
        assert!(problem.contains("look away") && problem.contains("OpenGL (y up, z backward)"), "{problem}");
    }

    /// Around the origin, camera to world read as world to camera is one place from which all look in one direction.
    #[test]
    fn a_ring_around_the_origin_given_camera_to_world_is_named() {
        for (turn, word) in [(Turn::None, "camera to world"), (Turn::OpenGl, "camera to world with OpenGL")] {
            let inverse = Convention { pose: Pose::CameraToWorld, turn };
            let cameras: Vec<Camera> = dome(Vec3::ZERO).iter().map(|c| write(inverse, c)).collect();
            let error = check(&cameras, meeting_point(cameras.iter())).unwrap_err();
            assert!(alloc::string::ToString::to_string(&error).contains(word), "{error}");
        }
    }

    #[test]
    fn rows_of_parallel_cameras_are_refused_and_converging_ones_are_not() {
        let row = |turn: f32| -> Vec<Camera> {
            let at = |i: u32| {
                let from = Vec3::new(0.3 * i as f32, 0.0, 0.0);
                camera(from, from + Vec3::new(turn * (3.0 - i as f32), 4.0, 0.0), 64, 60.0)
            };
            (0..7).map(at).collect()
        };
        let refused = |cameras: &[Camera]| check(cameras, meeting_point(cameras.iter())).err();
        for turn in [0.0, 0.02, -0.02] {
            let error = refused(&row(turn)).expect("parallel");
            assert!(alloc::string::ToString::to_string(&error).contains("axes are parallel"), "{turn}: {error}");
        }
        assert_eq!(refused(&row(0.3)), None);
        // They look away from each other.
        assert!(refused(&row(-0.3)).is_some());
    }

    #[test]
    fn rings_and_single_cameras_that_look_away_are_not_refused() {
        let mut cameras = dome(Vec3::new(5.0, 1.0, -2.0));
        assert_eq!(check(&cameras, meeting_point(cameras.iter())), Ok(()));
        cameras[2] = camera(Vec3::new(8.0, 1.0, -2.0), Vec3::new(9.0, 1.0, -2.0), 64, 60.0);
        assert_eq!(check(&cameras, meeting_point(cameras.iter())), Ok(()));
    }
}
